//! What is promised, and which check holds it to that.

/// A promise and its check: the name under which the check's result is kept, and how it is run.
pub(super) struct Promise {
    pub(super) promise: &'static str,
    pub(super) check: &'static str,
    pub(super) command: &'static str,
}

/// Some of the ordinary tests.
pub(super) struct Test {
    pub(super) name: &'static str,
    /// Of `cargo test`.
    pub(super) arguments: &'static [&'static str],
}

/// The ordinary tests that promises name.
pub(super) const TESTS: [Test; 10] = [
    Test { name: "properties", arguments: &["-p", "rdh", "--test", "properties"] },
    Test { name: "precise", arguments: &["-p", "rdh", "--test", "precise"] },
    Test { name: "builds", arguments: &["-p", "rdh", "--test", "builds"] },
    Test { name: "garbage", arguments: &["-p", "rdh", "--test", "garbage"] },
    Test { name: "saved", arguments: &["-p", "rdh", "--test", "saved"] },
    Test {
        name: "mutants",
        arguments: &["-p", "rdh", "--test", "saved", "--", "--ignored", "a_million_altered_files"],
    },
    Test { name: "allocation", arguments: &["-p", "rdh", "--lib", "build::"] },
    Test { name: "tune", arguments: &["-p", "rdh", "--test", "tune"] },
    Test { name: "hostile", arguments: &["-p", "rdh-scene", "--test", "hostile"] },
    Test { name: "answers", arguments: &["-p", "rdh-study", "--test", "identical"] },
];

const fn promise(promise: &'static str, check: &'static str, command: &'static str) -> Promise {
    Promise { promise, check, command }
}

/// All of them, in the order of the page.
pub(super) const PROMISES: [Promise; 21] = [
    promise("No ray escapes from a closed mesh", "soak", "cargo xtask soak --rays 1e9"),
    promise("Every structure gives the answers of brute force, bit for bit", "brute", "cargo xtask soak --brute"),
    promise(
        "The same on degenerate meshes, for all queries, masks and ends of rays; invalid rays hit nothing",
        "properties",
        "cargo test -p rdh --test properties",
    ),
    promise(
        "Double precision: the hits of brute force in f64, bit for bit, and no ray escapes",
        "precise",
        "cargo test -p rdh --test precise",
    ),
    promise(
        "The same tree from 1, 2, 7 and 16 threads and any instructions, the same answers from every tree",
        "identical",
        "cargo xtask deep identical",
    ),
    promise("The same on a few scenes, with every change", "answers", "cargo test -p rdh-study --test identical"),
    promise("The same hits from NEON, by emulation", "arm", "cargo xtask deep arm"),
    promise(
        "Any bits make a mesh that builds, and good triangles keep their hits",
        "garbage",
        "cargo test -p rdh --test garbage",
    ),
    promise(
        "Budgets are kept or refused; builds can be cancelled at any question",
        "builds",
        "cargo test -p rdh --test builds",
    ),
    promise("A build over 300,000 triangles asks every 50 ms whether to stop", "cancel", "cargo xtask deep cancel"),
    promise(
        "Where memory is refused a build is an error, and leaks nothing",
        "allocation",
        "cargo test -p rdh --lib build::",
    ),
    promise(
        "Saved trees are read as written; cut off or claiming anything, they are errors",
        "saved",
        "cargo test -p rdh --test saved",
    ),
    promise(
        "A million altered files are errors; a million more, signed anew, do no harm",
        "mutants",
        "cargo test -p rdh --test saved -- --ignored",
    ),
    promise("Hostile mesh files are errors that say where", "hostile", "cargo test -p rdh-scene --test hostile"),
    promise("What reads or builds survives libFuzzer and AddressSanitizer", "fuzz", "cargo xtask fuzz"),
    promise("No undefined behaviour that Miri sees", "miri", "cargo xtask deep miri"),
    promise("None that AddressSanitizer sees", "asan", "cargo xtask deep asan"),
    promise("It compiles for other systems", "targets", "cargo xtask deep targets"),
    promise("What is built in has permissive licences and known sources", "deny", "cargo xtask deep deny"),
    promise("Choices on all scenes hold on unseen rays, and for senseless profiles", "audit", "cargo xtask deep audit"),
    promise(
        "What is chosen by rays is never surely slower than what needs none",
        "tune",
        "cargo test -p rdh --test tune",
    ),
];
