# What developers do often. Each recipe is one command of `.ci/run` or of Cargo, which need no `just`.

# The recipes.
default:
    @just --list

# All tests, with everything switched on.
test:
    .ci/run tests

# Format and lints, the library with each feature alone, the documentation.
lint:
    .ci/run lint features documents

# Every system as a command.
smoke: build
    .ci/run smoke

# What decides whether a change is good.
ci *arguments:
    .ci/run {{arguments}}

# The benchmarks, or those whose names hold a word.
bench *words:
    cargo bench -p roverlab-bench -- {{words}}

# How the time of each system grows with its size: a table, and docs/curves.svg.
bench-curves:
    cargo bench -p roverlab-bench --bench curves -- --picture docs/curves.svg

# Whether a vision kernel has lost more than a tenth of its speed beside its peers since the last tag, or a commit.
bench-check since=`git describe --tags --abbrev=0 2>/dev/null || git rev-parse HEAD`:
    python3 benches/peers/vision.py --since {{since}}

# The pictures of the README's gallery, in docs/pictures.
pictures:
    .ci/pictures

# New cases for all properties, ten times as many as usual.
properties seed=`date +%N`:
    PROPTEST_RNG_SEED=$(printf '%s' {{seed}} | sed 's/^0*//') PROPTEST_CASES=2560 cargo test --workspace --all-features

[private]
build:
    cargo build --workspace
