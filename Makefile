# SPDX-License-Identifier: Apache-2.0
# The two commands of the README, and the longer suites. Each installs what is missing first (scripts/packages.sh).
.PHONY: demo test test-slow test-asan bench packages build format clean

BUILD := build/release

demo: build
	scripts/demo.sh $(BUILD)/lucerna

test: build
	ctest --preset release

test-slow: build
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -L slow

test-asan: packages
	cmake --preset asan && cmake --build --preset asan && ctest --preset asan

bench: build
	$(BUILD)/lucerna bench

build: packages
	cmake --preset release && cmake --build --preset release

packages:
	scripts/packages.sh

format:
	git ls-files '*.h' '*.cpp' '*.cu' | xargs clang-format -i

clean:
	rm -rf build demo
