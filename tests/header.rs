//! The committed C header against the sources it is made from.

use std::path::Path;

/// `UPDATE_HEADER=1 cargo test --test header` writes it anew.
#[test]
fn committed_header_is_what_the_sources_say() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml");
    let mut made = Vec::new();
    // It follows the modules that mod.rs names, and no others, so that no name elsewhere gets in.
    cbindgen::Builder::new()
        .with_config(config)
        .with_src(root.join("src/capi/mod.rs"))
        .generate()
        .expect("cbindgen reads src/capi")
        .write(&mut made);
    let made = String::from_utf8(made).expect("UTF-8");
    let path = root.join("include/complete_mesh.h");
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&path, &made).expect("include/complete_mesh.h is writable");
    }
    let committed = std::fs::read_to_string(&path).expect("include/complete_mesh.h");
    let differing = made.lines().zip(committed.lines()).position(|(a, b)| a != b);
    assert!(
        made == committed,
        "include/complete_mesh.h is not what the sources say (line {:?}): \
         UPDATE_HEADER=1 cargo test --test header",
        differing.map(|line| line + 1)
    );
}

/// A function that is exported but in none of the files above would be missing from the header.
#[test]
fn every_exported_function_is_declared() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = std::fs::read_to_string(root.join("include/complete_mesh.h")).expect("header");
    let mut exported = 0;
    for file in std::fs::read_dir(root.join("src/capi")).expect("src/capi") {
        let text = std::fs::read_to_string(file.expect("entry").path()).expect("UTF-8");
        for after in text.split("extern \"C\" fn ").skip(1) {
            let name = after.split('(').next().unwrap_or_default();
            if !name.starts_with("complete_mesh") || name == "complete_mesh_test_panic_at" {
                continue;
            }
            exported += 1;
            assert!(header.contains(&format!("{name}(")), "{name} is not in the header");
        }
    }
    assert!(exported > 30, "only {exported} functions found: is the search broken?");
}
