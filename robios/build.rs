//! Compiles the two functions of RoBIOS that take arguments like `printf`.

fn main() {
    println!("cargo:rerun-if-changed=src/shim.c");
    cc::Build::new().file("src/shim.c").warnings(true).compile("eyesim_shim");
}
