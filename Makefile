# SPDX-License-Identifier: Apache-2.0
# The two commands of the README, and the longer suites. Each installs what is missing first (scripts/packages.sh).
.PHONY: demo test test-report gallery test-slow test-asan bench packages build format clean

BUILD := build/release

demo: build
	scripts/demo.sh $(BUILD)/lucerna

test: build
	ctest --preset release

test-slow: build
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -L slow

test-asan: packages
	cmake --preset asan && cmake --build --preset asan && ctest --preset asan

# The HTML reports in a real browser: needs Chromium and two npm packages, which nothing else here does.
test-report: build
	scripts/packages.sh scripts/packages-report.txt
	cd tests/report && npm ci --no-audit --no-fund && LUCERNA=$(abspath $(BUILD)/lucerna) npm test

# The pictures of the README, from reports in the same browser.
gallery: build
	scripts/packages.sh scripts/packages-report.txt
	scripts/gallery.sh $(BUILD)/lucerna

bench: build
	$(BUILD)/bench/bench_trace
	$(BUILD)/bench/bench_read_write
	$(BUILD)/bench/bench_quality led

build: packages
	cmake --preset release && cmake --build --preset release

packages:
	scripts/packages.sh

format:
	git ls-files '*.h' '*.cpp' '*.cu' | xargs clang-format -i

clean:
	rm -rf build demo
