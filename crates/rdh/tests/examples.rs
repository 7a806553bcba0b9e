//! The examples run, and are short enough to be read.

macro_rules! examples {
    ($($name:ident: $file:literal),*) => {$(
        #[path = $file]
        mod $name;

        #[test]
        fn $name() {
            $name::main().unwrap();
            let lines = include_str!($file).lines().count();
            assert!(lines < 40, "{} has {lines} lines", $file);
        }
    )*};
}
examples!(
    first_hit: "../examples/first_hit.rs",
    all_hits: "../examples/all_hits.rs",
    record_and_tune: "../examples/record_and_tune.rs",
    load: "../examples/load.rs",
    far_from_home: "../examples/far_from_home.rs"
);
