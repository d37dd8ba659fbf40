//! Tables in text files, with a heading.

use husillo_sim::text::counted;

/// A table whose fields are found by the names of their columns.
pub struct Columns {
    names: Vec<String>,
    /// Line number and text of each row.
    rows: Vec<(usize, Box<str>)>,
}

/// Most rows of a table. More is no work of a person with a gauge.
const MOST_ROWS: usize = 250_000;

/// One row.
pub struct Row<'a> {
    columns: &'a Columns,
    line: usize,
    fields: Vec<&'a str>,
}

impl Columns {
    /// Reads a file, or standard input for `-`.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or [`Columns::parse`] fails.
    pub fn read(path: &str, known: &[&str]) -> Result<Self, String> {
        let text = crate::input::read_to_string(path);
        let text = text.map_err(|error| format!("{path}: {error}"))?;
        Self::parse(&text, known).map_err(|why| format!("{path}: {why}"))
    }

    /// Reads a text whose fields are separated by commas, semicolons or tabs. Empty lines and lines
    /// that begin with `#` are ignored.
    ///
    /// # Errors
    ///
    /// The heading is missing, a column is not in `known`, or a line has too many or too few
    /// fields.
    pub fn parse(text: &str, known: &[&str]) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| {
            let line = line.trim();
            !line.is_empty() && !line.starts_with('#')
        });
        let heading = format!("expected a heading with {}", known.join(", "));
        let (_, names) = lines.next().ok_or(heading.as_str())?;
        let names = names.to_ascii_lowercase();
        let names: Vec<String> = split(&names).map(str::to_owned).collect();
        if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
            return Err(format!("line 1: unknown column `{name}`: {heading}"));
        }
        let mut rows = Vec::new();
        for (line, text) in lines {
            let (there, wanted) = (split(text).count(), names.len());
            if there != wanted {
                let fields = counted(there, "field");
                return Err(format!(
                    "line {line}: {fields}, but {wanted} in the heading"
                ));
            }
            if rows.len() == MOST_ROWS {
                return Err(format!("line {line}: more than {MOST_ROWS} rows"));
            }
            rows.push((line, text.into()));
        }
        Ok(Self { names, rows })
    }

    /// Whether there is such a column.
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|there| there == name)
    }

    /// The rows in turn.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|(line, fields)| Row {
            columns: self,
            line: *line,
            fields: split(fields).collect(),
        })
    }
}

/// The fields of a line.
fn split(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', '\t']).map(str::trim)
}

impl Row<'_> {
    /// The field of a column.
    pub fn get(&self, name: &str) -> Option<&str> {
        let column = self.columns.names.iter().position(|there| there == name)?;
        self.fields.get(column).copied()
    }

    /// The field of a column, converted by `parse`.
    ///
    /// # Errors
    ///
    /// The table does not have the column, or `parse` fails. The message then has the line number.
    pub fn parsed<T>(
        &self,
        name: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, String> {
        let field = self
            .get(name)
            .ok_or_else(|| format!("there is no column `{name}`"))?;
        parse(field).map_err(|why| format!("line {}: {name}: {why}", self.line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_any_order() {
        let text = "# gauge 7\nReading; nominal\n1.0; 2\n\n3;4\n";
        let table = Columns::parse(text, &["nominal", "reading", "direction"]).unwrap();
        let nominal: Vec<_> = table
            .rows()
            .map(|row| row.get("nominal").unwrap().to_owned())
            .collect();
        assert_eq!(nominal, ["2", "4"]);
        assert!(!table.has("direction"));
    }

    #[test]
    fn bad_tables_are_refused_with_their_line() {
        let why = |text| Columns::parse(text, &["a", "b"]).err().unwrap();
        assert_eq!(why(""), "expected a heading with a, b");
        assert!(why("a,c\n").starts_with("line 1: unknown column `c`"));
        assert_eq!(
            why("a,b\n1,2\n3\n"),
            "line 3: 1 field, but 2 in the heading"
        );
    }
}
