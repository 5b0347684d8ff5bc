# SPDX-License-Identifier: Apache-2.0
# The two commands of the README, and the longer suites. Each installs what is missing first (scripts/packages.sh),
# but for check-quick and format.
# CUDA=1 compiles the CUDA back end too (needs nvcc).
.PHONY: reference demo test check check-quick fuzz bench benchmarks test-report test-site test-slow gallery docs program packages \
        install deb api format clean python test-python test-mpi test-bench bench-scorer bench-results

BUILD := build/release

demo: program
	scripts/demo.sh $(BUILD)/lucerna

test: program
	cmake --build --preset release --target tests
	ctest --preset release

# Every compiler and sanitizer, stage by stage (scripts/check.sh says which); a stage that passed for this commit is not run again.
check: packages
	scripts/packages.sh scripts/packages-check.txt scripts/packages-docs.txt scripts/packages-deb.txt
	scripts/check.sh $(STAGES)

# Seconds to minutes: the form of the tree, clang-tidy on what changed.
check-quick:
	scripts/check.sh format tree docs tidy-changed

# The Python package in build/release/python, and its quick tests; test-python: all of them.
python: program
	scripts/packages.sh scripts/packages-python.txt
	cmake --preset release -DLUCERNA_PYTHON=ON
	cmake --build --preset release --target python_package
	ctest --preset release -L python

test-python: python
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -L python

# lucerna-mpi under both MPI libraries of Debian: the bits of one process, signals, kills. Some minutes each. With OpenMPI, which
# Debian's mpi4py is built for, the Python package too; and a Slurm of one node where Slurm is installed.
test-mpi: packages
	scripts/packages.sh scripts/packages-mpi.txt scripts/packages-python.txt
	for mpi in openmpi mpich; do \
	  python=OFF; [ $$mpi = mpich ] || python=ON; \
	  cmake -S . -B build/$$mpi -G Ninja -DCMAKE_BUILD_TYPE=Release -DLUCERNA_CUDA=OFF -DLUCERNA_PYTHON=$$python -DLUCERNA_MPI=ON -DLUCERNA_MPI_TESTS=ON \
	    -DMPI_CXX_COMPILER=/usr/bin/mpicxx.$$mpi -DMPIEXEC_EXECUTABLE=/usr/bin/mpiexec.$$mpi && \
	  cmake --build build/$$mpi --target mpi_tests && \
	  ctest --test-dir build/$$mpi --output-on-failure --no-tests=error -L mpi || exit 1; \
	done

# make fuzz MINUTES=10: so many minutes for all targets together.
MINUTES ?= 10
fuzz: packages
	scripts/packages.sh scripts/packages-check.txt
	scripts/fuzz.sh $(MINUTES)

bench: program
	cmake --build --preset release --target benchmarks
	$(BUILD)/bench/bench_trace
	$(BUILD)/bench/bench_read_write
	$(BUILD)/bench/bench_quality led

# Runs the benchmarks whose tables stand in docs/benchmarks, and writes tables and plots there (an hour, on an idle machine);
# then bench-results.
benchmarks: program
	scripts/packages.sh scripts/packages-benchmarks.txt
	cmake --build --preset release --target benchmarks
	scripts/benchmarks.py --build $(BUILD)
	$(MAKE) bench-results

# Lucerna Bench (benchmarks/): its scorer, which needs nothing of Lucerna.
SCORER := build/bench-scorer/lucerna-bench-score
bench-scorer: packages
	scripts/packages.sh scripts/packages-bench.txt
	cmake -S benchmarks/scorer -B build/bench-scorer
	cmake --build build/bench-scorer -j $(shell nproc)

# Its tests, and those against the program.
test-bench: program bench-scorer
	ctest --test-dir build/bench-scorer --output-on-failure --no-tests=error
	LUCERNA=$(abspath $(BUILD)/lucerna) LUCERNA_BENCH_SCORER=$(abspath $(SCORER)) \
	  /usr/bin/python3 -m pytest -q benchmarks/python/tests

# Makes and scores entries of Lucerna and baselines for all tasks, and the forward tasks, for the site. On two idle cores that is 50
# minutes of making and hours of scoring. Entries are kept in build/bench-results, and are not made again for the same commit.
BENCH_TIME ?= 30
BENCH_RAYS ?= 1e8
bench-results: program bench-scorer
	/usr/bin/python3 benchmarks/run_entries.py --time $(BENCH_TIME) --rays $(BENCH_RAYS) --lucerna $(BUILD)/lucerna \
	  --scorer $(SCORER) -o build/bench-results
	/usr/bin/python3 benchmarks/run_forward.py tracing --lucerna $(BUILD)/lucerna --scorer $(SCORER) -o build/bench-results
	/usr/bin/python3 benchmarks/run_forward.py compression --lucerna $(BUILD)/lucerna -o build/bench-results
	mkdir -p docs/benchmarks/lucerna-bench
	cp build/bench-results/*.md build/bench-results/*.svg docs/benchmarks/lucerna-bench/

test-slow: program
	cmake --build --preset release --target tests
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -L slow

# The HTML reports in a real browser: needs Chromium and two npm packages, which nothing else here does.
test-report: program
	scripts/packages.sh scripts/packages-report.txt
	cd tests/report && npm ci --no-audit --no-fund && LUCERNA=$(abspath $(BUILD)/lucerna) npm test

# The site in the same browser: every page at two widths, its links, the search.
test-site: docs
	scripts/packages.sh scripts/packages-report.txt
	cd tests/report && npm ci --no-audit --no-fund && SITE=$(abspath build/docs) node --test --test-concurrency=1 site.mjs

# The pictures of the README, from reports in the same browser.
gallery: program
	scripts/packages.sh scripts/packages-report.txt
	scripts/gallery.sh $(BUILD)/lucerna

# The pages of docs/reference that follow from the code.
reference: program
	cmake --build --preset release --target write_reference_pages
	$(BUILD)/tests/write_reference_pages

# The site of the documentation, with what the headers say, in build/docs: begin with build/docs/index.html. No network; a link that
# leads nowhere is an error.
docs:
	scripts/packages.sh scripts/packages-docs.txt
	scripts/docs.sh

program: packages
	cmake --preset release -DLUCERNA_CUDA=$(if $(CUDA),ON,OFF)
	cmake --build --preset release --target lucerna_cli

packages:
	scripts/packages.sh

# Program, manual pages, libraries and headers: make install PREFIX=/usr/local (as root where the prefix asks for it).
PREFIX ?= /usr/local
install: program
	cmake --build --preset release --target installable
	cmake --install $(BUILD) --prefix $(PREFIX)

# Debian packages in build/deb/packages; make check STAGES=deb installs, uses and removes them in a bare Debian.
deb: packages
	scripts/packages.sh scripts/packages-deb.txt scripts/packages-python.txt scripts/packages-mpi.txt
	cmake --preset deb
	cmake --build --preset deb
	cpack --config build/deb/CPackConfig.cmake

# What the public headers say, as HTML in build/docs/api.
api:
	scripts/packages.sh scripts/packages-docs.txt
	scripts/api.sh

format:
	git ls-files '*.h' '*.cpp' '*.cu' | xargs clang-format -i

clean:
	rm -rf build demo
