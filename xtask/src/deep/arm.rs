//! The library's tests on 64-bit ARM, by emulation where the machine is another one: the NEON kernels, and the same bits.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use super::{Arguments, Outcome, says, tests};

const TARGET: &str = "aarch64-unknown-linux-gnu";
/// Debian's: a Rust of its own, since ours may lack the target's library.
const PACKAGES: &str = "qemu-user gcc-aarch64-linux-gnu libc6-dev:arm64 rustc-web cargo-web libstd-rust-web-dev:arm64";
/// Hours of emulation for a million rays; what it shows, batches from inside closed meshes and brute force show with fewer.
const TOO_LONG: &str = "no_ray_escapes_from_a_closed_mesh";
/// Where its libraries lie if they came with a cross compiler; others the emulator finds by itself.
const LIBRARIES: &str = "/usr/aarch64-linux-gnu";

pub(super) fn run(_: &Arguments) -> Result<Outcome> {
    if cfg!(target_arch = "aarch64") {
        return Ok(Outcome::Skipped("this machine is one, and the ordinary tests do it".into()));
    }
    let Some((cargo, rustc)) = toolchain() else {
        return Ok(Outcome::Skipped(format!("no Rust for {TARGET} is installed; Debian: {PACKAGES}")));
    };
    for tool in ["aarch64-linux-gnu-gcc", "qemu-aarch64"] {
        if !says(Command::new(tool).arg("--version")) {
            return Ok(Outcome::Skipped(format!("there is no {tool}; Debian: {PACKAGES}")));
        }
    }
    let mut command = Command::new(cargo);
    command.env("RUSTC", rustc).env_remove("RUSTUP_TOOLCHAIN");
    command.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", "aarch64-linux-gnu-gcc");
    command.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER", "qemu-aarch64");
    if Path::new(LIBRARIES).is_dir() {
        command.env("QEMU_LD_PREFIX", LIBRARIES);
    }
    command.args(["test", "--release", "-p", "rdh", "--target", TARGET, "--target-dir"]);
    command.arg(crate::target()?.join("arm"));
    command.args(["--lib", "--test", "properties", "--test", "builds", "--", "--skip", TOO_LONG]);
    tests(&mut command)
}

/// A cargo and a compiler that have the target's library.
fn toolchain() -> Option<(&'static str, &'static str)> {
    let found = [("cargo", "rustc"), ("/usr/bin/cargo", "/usr/bin/rustc")];
    found.into_iter().find(|(_, rustc)| {
        let folder = Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
        folder.is_ok_and(|out| Path::new(String::from_utf8_lossy(&out.stdout).trim()).is_dir())
    })
}
