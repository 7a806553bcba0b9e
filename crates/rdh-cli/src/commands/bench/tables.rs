//! The tables that `rdh bench` prints.

use rdh_study::bench::{BenchDocument, BenchRow, BenchSummary};

use crate::context::Styles;
use crate::table::{Cell, Table};

/// The rows, ours against each base, what builds cost, and what is missing.
pub(super) fn text(document: &BenchDocument, styles: &Styles) -> String {
    if document.rows.is_empty() {
        return "nothing was measured\n".to_owned();
    }
    let parts = [rows(document, styles), summary(document, styles), builds(document, styles), notes(document)];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

fn rows(document: &BenchDocument, styles: &Styles) -> String {
    let mut head = vec!["scene:view", "rays", "engine", ">Mrays/s", ">best", ">hits", ">lost", ">extra", ">differ"];
    let base = document.rows.iter().find_map(|row| row.base.clone());
    let against = base.as_ref().map(|base| format!(">/ {base}"));
    head.extend(against.as_deref());
    let mut table = Table::new(&head);
    let mut last = None;
    for row in &document.rows {
        let case = (&row.scene, &row.view, row.column);
        let first = last.replace(case) != Some(case);
        let name = if first { format!("{}:{}", row.scene, row.view) } else { String::new() };
        let column = if first { row.column.name() } else { "" };
        let mut cells: Vec<Cell> = vec![
            name.into(),
            column.into(),
            row.engine.clone().into(),
            format!("{:.2}", row.mrays_per_sec).into(),
            format!("{:.2}", row.mrays_per_sec_best).into(),
            hits(row).into(),
        ];
        cells.extend([row.lost, row.extra, row.differ].map(|n| difference(n, row, styles)));
        let speedup = base.as_ref().filter(|_| row.is_ours()).and_then(|base| document.speedup(row, base));
        cells.extend(speedup.map(|ratio| ratio_cell(ratio, styles)));
        table.push(cells);
    }
    table.text(styles.head)
}

fn hits(row: &BenchRow) -> String {
    format!("{:.1} %", 100.0 * row.hits as f64 / row.rays.max(1) as f64)
}

/// Nothing where nothing differs.
fn difference(count: u64, row: &BenchRow, styles: &Styles) -> Cell {
    match (count, row.agrees) {
        (0, _) => Cell::default(),
        (_, true) => count.to_string().into(),
        (_, false) => Cell::styled(format!("{count}!"), styles.worse),
    }
}

fn summary(document: &BenchDocument, styles: &Styles) -> String {
    if document.summary.is_empty() {
        return String::new();
    }
    let head = ["rays", "ours", "against the best of", ">scenes", ">speed-up", ">95 % interval", ">worst", "in"];
    let mut table = Table::new(&head);
    let mut last = None;
    for line in &document.summary {
        let first = last.replace((&line.base, line.column)) != Some((&line.base, line.column));
        table.push(summary_cells(line, first, styles));
    }
    let text = "our Mrays/s / those of the base's best mode, geometric mean over scenes; above 1 is better\n";
    text.to_owned() + &table.text(styles.head)
}

fn summary_cells(line: &BenchSummary, first: bool, styles: &Styles) -> Vec<Cell> {
    vec![
        if first { line.column.name() } else { "" }.into(),
        line.spec.clone().into(),
        line.base.clone().into(),
        line.n.to_string().into(),
        ratio_cell(line.speedup, styles),
        format!("{:.2}-{:.2}", line.ci95[0], line.ci95[1]).into(),
        ratio_cell(line.worst, styles),
        line.worst_scene.clone().into(),
    ]
}

fn builds(document: &BenchDocument, styles: &Styles) -> String {
    let mut table =
        Table::new(&["builds", ">scenes", ">M triangles", ">CPU s", ">s / M triangles", ">bytes / triangle"]);
    for line in &document.builds {
        table.push(vec![
            line.engine.clone().into(),
            line.n.to_string().into(),
            format!("{:.2}", line.triangles as f64 / 1e6).into(),
            format!("{:.2}", line.build_secs).into(),
            format!("{:.2}", line.secs_per_million).into(),
            format!("{:.0}", line.bytes_per_triangle).into(),
        ]);
    }
    table.text(styles.head)
}

fn notes(document: &BenchDocument) -> String {
    let settings = &document.settings;
    let mut text = format!(
        "{0} x {0} primary rays ({1} x {1} for slow engines), {2} rounds, one thread, CPU time; medians\n",
        settings.size, settings.slow_size, settings.rounds
    );
    for skipped in &document.skipped {
        text += &format!("skipped: {}: {}\n", skipped.engine, skipped.reason);
    }
    for failure in &document.failures {
        let engine = failure.engine.as_ref().map_or_else(String::new, |e| format!(" {e}"));
        text += &format!("failed: {}{engine}: {}\n", failure.scene, failure.reason);
    }
    text
}

fn ratio_cell(ratio: f64, styles: &Styles) -> Cell {
    let style = if ratio < 1.0 { styles.worse } else { styles.better };
    Cell::styled(format!("{ratio:.2}"), style)
}
