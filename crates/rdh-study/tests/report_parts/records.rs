//! A made-up study whose effects are known.

use rdh::{RayClass, Spec};
use rdh_scene::Kind;
use rdh_study::rows::Curve;
use rdh_study::study::{Job, Record};
use rdh_study::{Mode, Protocol, Row};

/// A row whose figures are those of the base times `factor`, a little different for each scene.
pub(crate) fn row(job: &Job, class: RayClass, spec: &str, factor: f64) -> Row {
    let spec: Spec = spec.parse().unwrap();
    let size = 1.0 + f64::from(number(&job.scene) % 7);
    let nanos = 100.0 * size * factor;
    let trained = usize::from(spec.needs_rays()) * 4096;
    Row {
        scene: job.scene.clone(),
        view: job.view.clone(),
        frame: job.frame,
        kind: kind(&job.scene),
        mode: job.mode,
        class,
        spec,
        chosen: None,
        triangles: (1000.0 * size) as usize,
        rays: 10_000,
        hits: 9_000,
        t_sum: 1.0,
        trained_on: trained,
        train_view: (trained > 0).then(|| job.view.clone()),
        train_frame: (trained > 0).then_some(job.frame),
        steps_per_ray: 30.0 * size * factor,
        tests_per_ray: 8.0 * size * factor * factor,
        empty_leaves_per_ray: 1.0,
        nanos_per_ray: nanos,
        round_nanos_per_ray: vec![nanos * 0.995, nanos, nanos * 1.005],
        build_secs: 0.02 * size * if trained > 0 { 2.5 } else { 1.0 },
        rrs_secs: if trained > 0 { 0.003 } else { 0.0 },
        nodes: 1000,
        references: (2000.0 * size * factor) as usize,
        bytes: (100_000.0 * size * factor) as usize,
        depth: 20,
        protocol: Protocol::Unseen,
        seed: 1,
        experiment: Some(job.experiment.clone()),
        setting: None,
        x: None,
        cost_p999: (300.0 * factor) as u64,
        depth_complexity: (job.experiment == "occlusion").then_some(1.0 + size),
    }
}

pub(crate) fn job(experiment: &str, scene: &str, view: &str, mode: Mode) -> Job {
    Job { experiment: experiment.into(), scene: scene.into(), view: view.into(), frame: 0, mode }
}

pub(crate) fn record(job: Job, rows: Vec<Row>) -> Record {
    Record { rows, ..Record::of(job) }
}

/// One record of `specs`, the first the base, each with the factor of all its figures.
pub(crate) fn simple(job: Job, specs: &[(&str, f64)]) -> Record {
    let classes = job.mode.classes();
    let rows = classes.iter().flat_map(|&c| specs.iter().map(move |s| (c, s)));
    let rows = rows.map(|(c, (spec, factor))| row(&job, c, spec, *factor)).collect();
    record(job, rows)
}

/// A study with every experiment.
pub(crate) fn study() -> Vec<Record> {
    let mut records = Vec::new();
    for (i, scene) in SCENES.iter().enumerate() {
        for (v, view) in ["front", "inside"].into_iter().enumerate() {
            let wobble = 1.0 + 0.03 * (((i * 7 + v * 3) % 11) as f64 - 5.0) / 5.0;
            let gain = match kind(scene) {
                Kind::Open => 0.97,
                Kind::Interior => 0.85,
                Kind::Dense => 0.7,
            } * wobble;
            records.extend(of_view(scene, view, gain));
        }
    }
    records
}

pub(crate) const SCENES: [&str; 12] = [
    "balls4",
    "gears4",
    "jacks5",
    "lattice12",
    "mount6",
    "rings7",
    "tetra6",
    "tree11",
    "rooms",
    "quarter",
    "grove",
    "terrain-of-a-long-name",
];

fn of_view(scene: &str, view: &str, gain: f64) -> Vec<Record> {
    let mut records = Vec::new();
    let papers_rule = ["kd(stop=paper,prune=none)+sah", "kd(stop=paper,prune=none)+rdh(paper)"];
    for mode in [Mode::Primary, Mode::Whitted] {
        let at = job("paper", scene, view, mode);
        let mut rows = Vec::new();
        for (setting, specs) in [
            ("the paper's rule", vec![(papers_rule[0], 1.4), (papers_rule[1], 1.36)]),
            ("ours", vec![("kd+sah", 1.0), ("kd+rdh(paper)", 0.99), ("kd+rdh", gain)]),
        ] {
            rows.extend(
                simple(at.clone(), &specs).rows.into_iter().map(|r| Row { setting: Some(setting.into()), ..r }),
            );
        }
        records.push(record(at, rows));
    }
    for mode in Mode::ALL {
        records.push(simple(
            job("modes", scene, view, mode),
            &[("kd+sah", 1.0), ("kd+rdh(paper)", 0.995), ("kd+rdh", gain)],
        ));
    }
    records.push(simple(job("occlusion", scene, view, Mode::Primary), &[("kd+sah", 1.0), ("kd+rdh", gain)]));
    records.push(simple(job("aa", scene, view, Mode::Primary), &[("kd+sah", 1.0), ("kd+sah", 1.0)]));
    records.push(simple(
        job("controls", scene, view, Mode::Primary),
        &[("kd+sah", 1.0), ("kd(stop=cost)+sah", 1.02), ("kd(prune=none)+sah", 1.08), ("kd+rdh", gain)],
    ));
    records.push(settings(
        "how-many",
        scene,
        view,
        &[100.0, 1000.0, 4096.0, 16384.0, 1e6]
            .map(|x: f64| (format!("{x} rays"), Some(x), "kd+rdh", 1.0 - (1.0 - gain) * (1.0 - 20.0 / (x + 20.0)))),
        ("same", "kd+rdh", gain * 0.98),
    ));
    records.push(settings(
        "which-rays",
        scene,
        view,
        &[1.0, 2.0, 4.0, 8.0].map(|x| (format!("previous:{x}"), Some(x), "kd+rdh", gain + 0.02 * x)),
        ("view:inside", "kd+rdh", 1.04),
    ));
    records.push(settings(
        "blend",
        scene,
        view,
        &[0.1, 0.3, 0.5, 0.7, 0.9].map(|x| (format!("weight {x}"), Some(x), "kd+rdh(paper)", 1.0 - 0.02 * x)),
        ("prior", "kd+rdh", gain),
    ));
    records.push(settings(
        "termination",
        scene,
        view,
        &[("cost", 1.01), ("auto", 1.0), ("paper", 1.3)].map(|(s, f)| (s.to_owned(), None, "kd+rdh", f * gain)),
        ("idle", "kd+rdh", 0.6),
    ));
    records.push(with_curves("assumptions", scene, view, gain));
    records.push(with_curves("bound", scene, view, gain));
    records
}

/// One setting each, with its own base.
fn settings(
    experiment: &str,
    scene: &str,
    view: &str,
    on: &[(String, Option<f64>, &str, f64)],
    last: (&str, &str, f64),
) -> Record {
    let at = job(experiment, scene, view, Mode::Primary);
    let last = [(last.0.to_owned(), None, last.1, last.2)];
    let rows = on.iter().chain(&last).flat_map(|(setting, x, spec, factor)| {
        let rows = simple(at.clone(), &[("kd+sah", 1.0), (*spec, *factor)]).rows;
        rows.into_iter().map(|r| Row { setting: Some(setting.clone()), x: *x, ..r })
    });
    let rows = rows.collect();
    record(at, rows)
}

fn with_curves(experiment: &str, scene: &str, view: &str, gain: f64) -> Record {
    let on = [("uniform whole", 1.0), ("uniform clipped", 0.97), ("real whole", 0.9), ("real clipped", gain)];
    let on = on.map(|(s, f)| (s.to_owned(), None, "kd+rdh", f));
    let mut record = settings(experiment, scene, view, &on, ("local search", "kd+rdh", gain * 0.95));
    let job = record.job.clone();
    let curve = |name: &str, error: f64| Curve {
        experiment: job.experiment.clone(),
        scene: job.scene.clone(),
        view: job.view.clone(),
        mode: job.mode,
        name: format!("error of p, {name}"),
        spec: Spec::default(),
        across: "depth".into(),
        points: (0..20).map(|d| [f64::from(d), error * (1.0 + 0.1 * f64::from(d)), 1000.0]).collect(),
    };
    record.curves = vec![curve("areas", 0.2), curve("real whole", 0.1), curve("real clipped", 0.03)];
    record
}

pub(crate) fn kind(scene: &str) -> Kind {
    match scene {
        "lattice12" | "rings7" => Kind::Interior,
        "rooms" | "quarter" => Kind::Dense,
        _ => Kind::Open,
    }
}

fn number(text: &str) -> u32 {
    text.bytes().map(u32::from).sum()
}
