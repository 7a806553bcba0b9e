//! The tables that `rdh compare` prints.

use clap::builder::styling::Style;
use rdh::RayClass;
use rdh_study::{Document, Plan, Row, Summary};

use crate::context::Styles;
use crate::table::{Cell, Table};

/// The rows, the summary, and what they are.
pub(super) fn text(document: &Document, plan: &Plan, styles: &Styles) -> String {
    if document.rows.is_empty() {
        return "nothing was measured\n".to_owned();
    }
    let parts = [rows_text(&document.rows, styles), summary_text(&document.summary, styles), explanation(plan)];
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
        row.spec.to_string().into(),
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

/// The class, with its mode where that says more.
fn class_name(row: &Row) -> String {
    let (mode, class) = (row.mode.name(), row.class.name());
    if mode == class { class.to_owned() } else { format!("{mode} {class}") }
}

fn summary_text(summary: &[Summary], styles: &Styles) -> String {
    let Some(first) = summary.first() else { return String::new() };
    let base = first.base.to_string();
    let against = format!("spec / {base}");
    let mut table = Table::new(&[
        &against,
        "rays of",
        ">pairs",
        ">steps",
        ">tests",
        ">time",
        "95 % interval",
        ">build",
        ">+rays",
        ">bytes",
        ">slower",
    ]);
    for s in summary {
        let [low, high] = s.time_ratio_ci95;
        let class = s.class.map_or("all", RayClass::name);
        let class = if s.mode.name() == class { class.to_owned() } else { format!("{} {class}", s.mode) };
        let mut row: Vec<Cell> = vec![s.spec.to_string().into(), class.into(), s.n.to_string().into()];
        row.extend([s.steps_ratio, s.tests_ratio, s.time_ratio].map(|ratio| ratio_cell(ratio, styles)));
        row.push(format!("{low:.3} to {high:.3}").into());
        row.extend([s.build_ratio, s.build_and_rrs_ratio, s.bytes_ratio].map(|r| Cell::from(format!("{r:.2}"))));
        row.push(s.slower_cases.to_string().into());
        table.push(row);
    }
    table.text(styles.head)
}

/// A ratio to the base, green if it is better and red if it is worse, by more than 1 %.
fn ratio_cell(ratio: f64, styles: &Styles) -> Cell {
    let style = match ratio {
        r if r < 0.99 => styles.better,
        r if r > 1.01 => styles.worse,
        _ => Style::new(),
    };
    Cell::styled(format!("{ratio:.3}"), style)
}

fn explanation(plan: &Plan) -> String {
    format!(
        "Ratios are to the first spec; below 1 is better; in the summary geometric means over pairs of the same rays.\n\
         build: CPU time of one thread; +rays: with recording the training rays; slower: pairs that are surely slower.\n\
         {} x {} rays a view, at most {} training rays ({}), seed {}.\n",
        plan.size[0], plan.size[1], plan.training, plan.protocol, plan.seed
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_is_green_worse_is_red_and_equal_is_plain() {
        let styles = Styles { better: Style::new().bold(), worse: Style::new().italic(), ..Styles::default() };
        let mut table = Table::new(&["a", "b", "c"]);
        table.push([0.5, 1.5, 1.0].map(|r| ratio_cell(r, &styles)).into());
        let text = table.text(Style::new());
        assert!(text.contains(&format!("{}0.500", Style::new().bold().render())), "{text:?}");
        assert!(text.contains(&format!("{}1.500", Style::new().italic().render())), "{text:?}");
        assert!(text.contains("  1.000\n"), "{text:?}");
    }
}
