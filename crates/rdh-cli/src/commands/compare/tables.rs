//! The tables that `rdh compare` prints.

use rdh_study::{Document, Plan, Row, summarise};

use crate::context::Styles;
use crate::summary::{ratio_cell, summary_text};
use crate::table::{Cell, Table};

/// The rows, the summary, that of a subset of the scenes, and what they are.
pub(super) fn text(document: &Document, plan: &Plan, subset: &[String], styles: &Styles) -> String {
    if document.rows.is_empty() {
        return "nothing was measured\n".to_owned();
    }
    let parts = [
        rows_text(&document.rows, styles),
        summary_text(&document.summary.iter().collect::<Vec<_>>(), styles),
        subset_text(document, plan, subset, styles),
        explanation(plan),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

fn rows_text(rows: &[Row], styles: &Styles) -> String {
    let mut columns = vec!["scene:view", "rays of", "spec", ">steps/ray", ">tests/ray", ">ns/ray", ">build s", ">MB"];
    let ratios = rows.iter().any(|row| row.spec != rows[0].spec);
    if ratios {
        columns.extend([">steps", ">tests", ">time"]);
    }
    let mut table = Table::new(&columns);
    let mut last = None;
    for row in rows {
        let case = (&row.scene, &row.view, row.frame, row.class);
        let base = base_of(row, rows);
        table.push(row_cells(row, base, last.as_ref() != Some(&case), styles));
        last = Some(case);
    }
    table.text(styles.head)
}

fn subset_text(document: &Document, plan: &Plan, subset: &[String], styles: &Styles) -> String {
    let rows: Vec<Row> = document.rows.iter().filter(|row| subset.contains(&row.scene)).cloned().collect();
    if rows.is_empty() {
        return String::new();
    }
    let summary = summarise(&rows, &plan.specs[0]);
    format!("{}:\n{}", subset.join(", "), summary_text(&summary.iter().collect::<Vec<_>>(), styles))
}

/// The first spec's row of the same rays, unless this is it.
fn base_of<'r>(row: &Row, rows: &'r [Row]) -> Option<&'r Row> {
    let same = |other: &&Row| {
        (&other.scene, &other.view, other.frame, other.mode, other.class)
            == (&row.scene, &row.view, row.frame, row.mode, row.class)
    };
    rows.iter().find(same).filter(|base| base.spec != row.spec)
}

fn row_cells(row: &Row, base: Option<&Row>, first: bool, styles: &Styles) -> Vec<Cell> {
    let frame = if row.frame > 0 { format!("@{}", row.frame) } else { String::new() };
    let [name, class] = if first {
        [format!("{}:{}{frame}", row.scene, row.view), class_name(row)]
    } else {
        [String::new(), String::new()]
    };
    let mut cells: Vec<Cell> = vec![
        name.into(),
        class.into(),
        spec_name(row).into(),
        format!("{:.1}", row.steps_per_ray).into(),
        format!("{:.1}", row.tests_per_ray).into(),
        format!("{:.0}", row.nanos_per_ray).into(),
        format!("{:.3}", row.build_secs).into(),
        format!("{:.1}", row.bytes as f64 / 1e6).into(),
    ];
    if let Some(base) = base {
        let pairs = [
            (row.steps_per_ray, base.steps_per_ray),
            (row.tests_per_ray, base.tests_per_ray),
            (row.nanos_per_ray, base.nanos_per_ray),
        ];
        cells.extend(pairs.map(|(a, b)| ratio_cell(if a == b { 1.0 } else { a / b }, styles)));
    }
    cells
}

/// The spec; for `auto` with what it chose.
fn spec_name(row: &Row) -> String {
    row.chosen.map_or_else(|| row.spec.to_string(), |chosen| format!("{}: {chosen}", row.spec))
}

/// The class, with its mode where that says more.
fn class_name(row: &Row) -> String {
    let (mode, class) = (row.mode.name(), row.class.name());
    if mode == class { class.to_owned() } else { format!("{mode} {class}") }
}

fn explanation(plan: &Plan) -> String {
    format!(
        "Ratios are to the first spec; below 1 is better; in the summary geometric means over pairs of the same rays.\n\
         build: CPU time of one thread; +rays: with recording the training rays; faster, slower: pairs that surely are.\n\
         {} x {} rays a view, at most {} training rays ({}), seed {}.\n",
        plan.size[0], plan.size[1], plan.training, plan.protocol, plan.seed
    )
}
