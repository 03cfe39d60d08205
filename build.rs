//! Gives the shared library its soname: without one, programs would record the file name they
//! were linked with and load any later, incompatible library of that name.

/// First number of the shared library's version: changes when the C ABI breaks. The tests compare
/// it with `COMPLETE_MESH_ABI_VERSION` of the header.
const ABI_VERSION: u32 = 0;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let os = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    match os.as_str() {
        "linux" | "android" | "freebsd" | "netbsd" | "openbsd" | "dragonfly" => println!(
            "cargo:rustc-cdylib-link-arg=-Wl,-soname,libcomplete_mesh.so.{ABI_VERSION}"
        ),
        "macos" => println!(
            "cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libcomplete_mesh.{ABI_VERSION}.dylib"
        ),
        _ => {}
    }
}
