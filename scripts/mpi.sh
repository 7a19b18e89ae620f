#!/usr/bin/env bash
# The program on several ranks: builds the feature `mpi` into the same target directory as `cargo test`, and tests what needs MPI and PETSc on 2 ranks (RANKS=N: on N).
# Needs PETSc and MPI: on Debian and Ubuntu they are installed if they are missing and this is root (or sudo asks). Nothing of it is needed for `.ci/run`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

ranks="${RANKS:-2}"
if ! { command -v mpicc && command -v mpirun && { pkg-config --exists PETSc || pkg-config --exists petsc; }; } >/dev/null 2>&1; then
    command -v apt-get >/dev/null || { echo "skipped: no PETSc and MPI here, and no apt-get to install them (docs/guide/clusters.md)"; exit 0; }
    root=()
    [ "$(id -u)" = 0 ] || root=(sudo)
    "${root[@]}" apt-get update -qq
    "${root[@]}" apt-get install -y -qq --no-install-recommends libpetsc-real-dev openmpi-bin pkg-config
fi

# Ranks share cores here; root may run containers of a CI.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1 OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
together() { timeout 300 mpirun --oversubscribe --bind-to none -n "$@"; }
built="${CARGO_TARGET_DIR:-target}/debug"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Of all members at once, so that what the tests have built serves again.
cargo build --workspace --features stoss-cli/mpi
cargo build --workspace --example ranks --features stoss-cli/mpi,stoss-linalg-petsc/petsc
cargo clippy --quiet -p stoss-linalg-petsc --all-targets --features petsc -- -D warnings

echo "== sums, texts, exchanges, systems"
for n in 1 "$ranks" 3; do together "$n" "$built/examples/ranks"; done

echo "== a rank that panics ends all"
code=0
together "$ranks" "$built/examples/ranks" panic >"$scratch/panic" 2>&1 || code=$?
grep -q "it has panicked; all ranks end" "$scratch/panic" && [ "$code" = 1 ]

echo "== scenes on one rank and on $ranks"
# Multigrid; MUMPS with multipliers of contact with friction; the same with options of PETSc; general contact, without multipliers.
scene() {
    cat <<SCENE
[scene]
title = "$1"
kind = "$2"
[time]
end = $3
step = $4
$5
SCENE
}
block() { printf '[[body]]\nname = "%s"\nmesh = { generator = "block", min = %s, max = %s, divisions = %s }\nmaterial = { law = "neo-hooke", young = 1e6, poisson = 0.3 }\ndensity = 1000.0\n%s\n' "$@"; }
impact() {
    scene "$1" dynamic 0.008 0.001 'integrator = { scheme = "energy-momentum" }'
    block lower "[0, 0, 0]" "[2, 2, 1]" "[4, 4, 2]" ""
    block upper "[0.3, 0.3, 1.004]" "[1.3, 1.3, 2.004]" "[3, 3, 2]" "velocity = [3.0, 2.0, -2.0]"
    printf '[[probe]]\nname = "upper"\nset = "upper.bottom"\nquantity = "position"\n'
}
{
    scene cube quasi-static 1.0 0.5 ''
    block cube "[0, 0, 0]" "[1, 1, 1]" "[10, 10, 10]" ""
    printf '[[prescribe]]\nset = "cube.bottom"\ncomponents = ["x", "y", "z"]\nfixed = true\n[[prescribe]]\nset = "cube.top"\ncomponents = ["x", "z"]\ndisplacement = { table = [[0, 0, 0], [1, 0.1, -0.1]] }\n'
    printf '[[probe]]\nname = "top"\nset = "cube.top"\nquantity = "reaction"\n'
} >"$scratch/cube.toml"
{ impact mortar; printf '[[contact]]\nmethod = "mortar"\nslave = "upper.bottom"\nmaster = "lower.top"\nfriction = { law = "coulomb", mu = 0.2 }\n'; } >"$scratch/mortar.toml"
{ impact general; printf '[general_contact]\nfriction = 0.2\n[solver]\npetsc = "-ksp_type gmres -ksp_rtol 1e-12 -pc_type bjacobi"\n'; } >"$scratch/general.toml"
for name in cube mortar general; do
    "$built/stoss" run "$scratch/$name.toml" --out "$scratch/$name.1" --threads 1 --quiet --no-report
    together "$ranks" "$built/stoss" run "$scratch/$name.toml" --out "$scratch/$name.n" --quiet --no-report
    # Probes, against the largest of the table; MUMPS, GAMG and one rank's solvers differ in round-off only.
    awk -F, -v name="$name" '
        FNR == 1 { next }
        NR == FNR { for (k = 3; k <= NF; k++) { one[FNR, k] = $k + 0; size = $k < 0 ? -$k : $k; if (size > largest) largest = size }; rows = FNR; next }
        { for (k = 3; k <= NF; k++) { off = $k - one[FNR, k]; if (off < 0) off = -off; if (off > worst) worst = off }; found = FNR }
        END {
            printf "%s: %d rows, largest difference %.1e of %.1e\n", name, rows - 1, worst, largest
            exit !(rows > 2 && rows == found && worst <= 1e-9 * largest)
        }' "$scratch/$name.1/probes.csv" "$scratch/$name.n/probes.csv"
done
[ "$(ls -d "$scratch"/*.n | wc -l)" = 3 ]

echo "== an error has one message and its code"
code=0
touch "$scratch/file"
together "$ranks" "$built/stoss" run "$scratch/cube.toml" --out "$scratch/file" >"$scratch/error" 2>&1 || code=$?
[ "$code" = 1 ] && [ "$(grep -c '^error: ' "$scratch/error")" = 1 ]
echo "all well"
