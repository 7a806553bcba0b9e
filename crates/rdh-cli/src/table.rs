//! Text tables: columns as wide as they need to be, numbers to the right.

use clap::builder::styling::Style;

/// A table that grows row by row.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

/// The head of a column.
#[derive(Debug, Clone)]
struct Column {
    name: String,
    right: bool,
}

/// One entry.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cell {
    text: String,
    style: Style,
}

impl Cell {
    /// Text in a style.
    pub(crate) fn styled(text: impl Into<String>, style: Style) -> Self {
        Self { text: text.into(), style }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self::styled(text, Style::new())
    }
}

impl Table {
    /// A table without rows. A `>` in front of a column's name sets it to the right.
    pub(crate) fn new(columns: &[&str]) -> Self {
        let column = |name: &&str| match name.strip_prefix('>') {
            Some(name) => Column { name: name.to_owned(), right: true },
            None => Column { name: (*name).to_owned(), right: false },
        };
        Self { columns: columns.iter().map(column).collect(), rows: Vec::new() }
    }

    /// Adds a row; missing cells at its end stay empty.
    pub(crate) fn push(&mut self, row: Vec<Cell>) {
        self.rows.push(row);
    }

    /// The table as text, its head in `head` style; every line ends in a line feed, none in blanks.
    pub(crate) fn text(&self, head: Style) -> String {
        let names = self.columns.iter().map(|c| Cell::styled(c.name.clone(), head)).collect::<Vec<_>>();
        let widths = self.widths();
        std::iter::once(&names).chain(&self.rows).map(|row| self.line(row, &widths)).collect()
    }

    fn widths(&self) -> Vec<usize> {
        let cells = |i: usize| self.rows.iter().filter_map(move |r| r.get(i)).map(|c| c.text.chars().count());
        let width = |(i, c): (usize, &Column)| cells(i).chain([c.name.chars().count()]).max().unwrap_or(0);
        self.columns.iter().enumerate().map(width).collect()
    }

    fn line(&self, row: &[Cell], widths: &[usize]) -> String {
        let mut line = String::new();
        let mut owed = 0;
        for ((cell, column), width) in row.iter().zip(&self.columns).zip(widths) {
            let blank = width - cell.text.chars().count();
            let (before, after) = if column.right { (blank, 0) } else { (0, blank) };
            if !cell.text.is_empty() {
                line.extend(std::iter::repeat_n(' ', owed + before));
                line += &format!("{}{}{}", cell.style.render(), cell.text, cell.style.render_reset());
                owed = after;
            } else {
                owed += width;
            }
            owed += 2;
        }
        line + "\n"
    }
}

/// A coordinate with enough digits to recognise a place by.
pub(crate) fn short_coordinate(x: f64) -> String {
    let digits = match x.abs() {
        size if size >= 1000.0 => 0,
        size if size >= 10.0 => 1,
        _ => 3,
    };
    let text = format!("{x:.digits$}");
    // Nobody wants to read of a negative zero.
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!([0.12345, -0.0001, 85_000.4, -12.34].map(short_coordinate), ["0.123", "0.000", "85000", "-12.3"]);
    }

    #[test]
    fn numbers_stand_right_and_lines_end_without_blanks() {
        let mut table = Table::new(&["scene", ">rays", "note"]);
        table.push(vec!["balls4".into(), "7".into()]);
        table.push(vec!["a".into(), "".into(), "x".into()]);
        table.push(vec!["b".into(), "12345".into(), "".into()]);
        let text = table.text(Style::new());
        assert_eq!(text, "scene    rays  note\nballs4      7\na              x\nb       12345\n");
    }
}
