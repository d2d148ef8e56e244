//! How the command line is linked: at a fixed place, where the system lets it. As a program that can be loaded anywhere it would first
//! correct some ten thousand addresses in itself, a third of the time of `hrdsl --version`.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let is = |key: &str, value: &str| env::var(key).is_ok_and(|found| found == value);
    if is("CARGO_CFG_TARGET_OS", "linux") && is("CARGO_CFG_TARGET_ENV", "gnu") {
        println!("cargo:rustc-link-arg-bins=-no-pie");
    }
}
