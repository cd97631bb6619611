# One command per habit; `make help` lists them. Every target that runs Python sets up what it needs first.

PYTHON ?= python3
VENV   ?= .venv
RUN    ?= outputs/latest
RUNS   ?= $(RUN)
STUDY  ?= ablations/studies/reduced.yaml
LAUNCHER ?= parallel
POLICY ?= src/camp/assets/policies/go2_camp
ARGS   ?=
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
PORT   ?= 8000
NPM    := web/node_modules/.package-lock.json

# MuJoCo renders off-screen through EGL, or through OSMesa (slower) where no EGL library is installed; to
# choose yourself: `make MUJOCO_GL=osmesa train`. macOS has its own renderer and needs neither.
ifeq ($(shell uname -s),Linux)
export MUJOCO_GL ?= $(if $(shell ldconfig -p 2>/dev/null | grep -F libEGL.so),egl,osmesa)
endif

.DEFAULT_GOAL := help
.PHONY: help setup demo web web-serve web-check play test lint check train evaluate leaderboard transfer figures ablations dataset bench clean
.NOTPARALLEL:

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))
	@echo "ARGS='...' is passed on, e.g. make train ARGS='seed=1'. Run folders lie under outputs/."

setup: $(STAMP) ## create .venv and install the pinned dependencies (once)

# make runs this only while the stamp is missing or older than a list of dependencies.
$(STAMP): pyproject.toml constraints.txt
	@command -v "$(PYTHON)" >/dev/null || { \
		echo "error: PYTHON=$(PYTHON): no such command; install Python 3.11 or newer, or pass PYTHON=<path>" >&2; exit 2; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "error: PYTHON=$(PYTHON) is $$("$(PYTHON)" -V 2>&1): camp needs 3.11 or newer; pass PYTHON=<path of one>" >&2; exit 2; }
	@"$(PYTHON)" -c 'import venv, ensurepip' 2>/dev/null || { \
		echo "error: PYTHON=$(PYTHON): the venv module is missing; install it (Debian, Ubuntu: apt install python3-venv)" >&2; exit 2; }
	@echo "setting up $(VENV) (minutes, the first time)"
	"$(PYTHON)" -m venv "$(VENV)"
	"$(BIN)/python" -m pip install --quiet --no-compile --disable-pip-version-check -e '.[dev]' -c constraints.txt
	@touch "$@"

demo: setup ## the shipped policy: short evaluation, a video of switches, figures (under 3 minutes)
	"$(BIN)/python" -m camp.evaluate run="$(POLICY)" suite=short $(ARGS)
	"$(BIN)/python" -m analysis run="$(POLICY)" only=training,confusion,contacts,film_strip

web: setup $(NPM) ## build the web page of POLICY into web/dist
	"$(BIN)/python" -m web.inputs run="$(POLICY)" output=web/public
	npm --prefix web run --silent build
	@echo "web/dist is ready for any web server; look at it: make web-serve"

# npm writes the stamp itself, once all packages are there.
$(NPM): web/package.json web/package-lock.json
	@command -v npm >/dev/null || { echo "error: npm: no such command; install Node.js 20 or newer" >&2; exit 2; }
	npm --prefix web ci --ignore-scripts --no-audit --no-fund
	@touch "$@"

web-serve: ## serve web/dist at http://localhost:8000 (PORT=8000)
	@test -f web/dist/index.html || { echo "error: web/dist: not there; run make web" >&2; exit 2; }
	"$(PYTHON)" -m http.server --directory web/dist "$(PORT)"

web-check: web ## try the web page in headless Chromium, screenshots in outputs/web (minutes)
	npm --prefix web run --silent check

play: setup ## play with RUN (default: the latest run, or else POLICY) in the browser (PORT=8000)
	"$(BIN)/python" -m camp.play run="$(if $(wildcard $(RUN)),$(RUN),$(POLICY))" port="$(PORT)" $(ARGS)

test: setup ## run all tests, a file at a time on each of up to four processors
	@if command -v npm >/dev/null; then $(MAKE) --no-print-directory $(NPM) || \
		echo "warning: npm's packages are not there: the tests of the web page are skipped" >&2; fi
	PYTHONDONTWRITEBYTECODE= "$(BIN)/python" -m pytest -n auto --maxprocesses 4 --dist loadfile $(ARGS)

lint: setup ## check format, lint and types without changing a file (what CI runs before the tests)
	"$(BIN)/ruff" format --check .
	"$(BIN)/ruff" check .
	"$(BIN)/pyright" --pythonpath "$(BIN)/python"

check: setup ## format, mend what ruff can mend, then lint, check types and run the fast tests
	"$(BIN)/ruff" format .
	"$(BIN)/ruff" check --fix .
	"$(BIN)/pyright" --pythonpath "$(BIN)/python"
	"$(BIN)/python" -m pytest -m "not slow" $(ARGS)

train: setup ## train with the 30-minute preset, evaluate the run, draw its figures
	"$(BIN)/python" -m camp.train $(ARGS)
	@run="$$(readlink -f outputs/latest)"; $(MAKE) --no-print-directory evaluate RUN="$$run" ARGS= && \
		$(MAKE) --no-print-directory figures RUNS="$$run" ARGS=wandb=auto

evaluate: setup ## evaluate RUN: table, eval.json, eval.npz, videos
	"$(BIN)/python" -m camp.evaluate run="$(RUN)" $(ARGS)

# Results that are there already are kept: delete outputs/judge to judge anew.
leaderboard: setup ## put judged policies side by side: outputs/leaderboard/index.html
	"$(BIN)/python" -m analysis.open_loop outputs/open_loop
	@test -f outputs/judge/open_loop.json || "$(BIN)/python" -m camp.judge \
		policy=outputs/open_loop/open_loop.onnx contract=outputs/open_loop/open_loop.json
	@test -f outputs/judge/expert.json || "$(BIN)/python" -m camp.judge expert
	"$(BIN)/python" -m camp.leaderboard $(ARGS)

transfer: setup ## walk in four physics engines: the table of engines, outputs/transfer/engines.png (minutes)
	"$(BIN)/python" -m camp.transfer "$(POLICY)" engine=all $(ARGS)
	"$(BIN)/python" -m analysis.transfer

# From a fresh clone, without a run of one's own, those of the shipped policy.
figures: setup ## draw the figures of RUNS (default: the latest run), PDF and PNG, and of the studies' results
	@code=0; for run in $(if $(wildcard $(RUNS)),$(RUNS),$(if $(filter outputs/latest,$(RUNS)),$(POLICY),$(RUNS))); do \
		"$(BIN)/python" -m analysis run="$$run" $(ARGS) || code=$$?; done; exit $$code

ablations: setup ## run STUDY with Hydra's LAUNCHER, or go on with it, and write ablations/results/
	"$(BIN)/python" -m analysis.ablations "$(STUDY)" hydra/launcher="$(LAUNCHER)" $(ARGS)

dataset: setup ## generate the expert motions that are missing (all: ARGS=--overwrite)
	"$(BIN)/python" -m camp.dataset $(ARGS)

bench: setup ## measure simulation, environment and training speed (sim=gpu, sim=cpu)
	"$(BIN)/python" -m camp.bench $(if $(sim),sim=$(sim)) $(ARGS)

clean: ## remove the virtual environment, builds and caches (never outputs/)
	rm -rf "$(VENV)" build dist web/dist web/public web/node_modules .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -not -path './outputs/*' -prune -exec rm -rf {} +
