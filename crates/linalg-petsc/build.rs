//! Compiles the C side with the MPI compiler and the flags of PETSc's pkg-config file; without the feature `petsc` it does nothing.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "petsc")]
    petsc::build();
}

#[cfg(feature = "petsc")]
mod petsc {
    use std::process::Command;

    const REMEDY: &str = "install PETSc and MPI (Debian: apt install libpetsc-real-dev openmpi-bin), or name the folder of PETSc.pc in PKG_CONFIG_PATH; see docs/guide/clusters.md";

    /// What `pkg-config` says of PETSc.
    fn flags(what: &str) -> Vec<String> {
        // PETSc installs itself under both names, Debian under the first.
        for name in ["PETSc", "petsc"] {
            match Command::new("pkg-config").args([what, name]).output() {
                Ok(output) if output.status.success() => {
                    return String::from_utf8_lossy(&output.stdout).split_whitespace().map(str::to_owned).collect();
                }
                Ok(_) => {}
                Err(error) => panic!("pkg-config, which finds PETSc, does not start: {error}; {REMEDY}"),
            }
        }
        panic!("pkg-config does not know PETSc; {REMEDY}");
    }

    pub fn build() {
        println!("cargo:rerun-if-changed=src/petsc.c");
        for variable in ["MPICC", "PKG_CONFIG_PATH"] {
            println!("cargo:rerun-if-env-changed={variable}");
        }
        let mut build = cc::Build::new();
        build.compiler(std::env::var("MPICC").unwrap_or_else(|_| "mpicc".to_owned())).file("src/petsc.c");
        build.warnings(true).extra_warnings(true);
        flags("--cflags").iter().filter_map(|flag| flag.strip_prefix("-I")).for_each(|path| {
            // Warnings are of our file.
            build.flag("-isystem").flag(path);
        });
        build.compile("stoss_petsc");
        for flag in flags("--libs") {
            if let Some(path) = flag.strip_prefix("-L") {
                println!("cargo:rustc-link-search=native={path}");
            } else if let Some(library) = flag.strip_prefix("-l") {
                println!("cargo:rustc-link-lib={library}");
            }
        }
        println!("cargo:rustc-link-lib=mpi");
    }
}
