//! Columns as the user states them: `force=Force_N [N], pressure=P1 [psi]`.

use crate::error::MeasurementError;
use crate::heading::Field;
use crate::quote::quoted;

/// Assigns columns to quantities where a file doesn't state them or states them wrongly.
///
/// ```
/// use bulge_measurements::ColumnMap;
/// let columns: ColumnMap = "force=Force_N [N], pressure=P1 [psi], length=-Weg".parse()?;
/// assert_eq!(columns.entries().len(), 3);
/// # Ok::<(), bulge_measurements::MeasurementError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ColumnMap(Vec<ColumnEntry>);

/// One quantity and its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnEntry {
    /// The quantity, such as `force`; `ignore` if the column isn't to be read.
    pub quantity: String,
    /// The heading of the column, with or without its unit, or its number, counted from 1.
    pub column: String,
    /// Its unit, if one is given.
    pub unit: Option<String>,
    /// Whether its sign is reversed, written as a minus before the column.
    pub is_reversed: bool,
}

impl ColumnMap {
    /// The entries in the order in which they were given.
    #[must_use]
    pub fn entries(&self) -> &[ColumnEntry] {
        &self.0
    }

    /// Adds an entry from its two sides: `force` and `Force_N [N]`.
    ///
    /// # Errors
    /// If the quantity doesn't exist or already has a column, or if the column already belongs to another
    /// quantity.
    pub fn add(&mut self, quantity: &str, column: &str) -> Result<(), MeasurementError> {
        let wrong = |what: String| Err(MeasurementError::ColumnMap(what));
        let quantity = quantity.trim().to_lowercase().replace([' ', '-'], "_");
        let is_known = quantity == IGNORE || Field::ALL.iter().any(|field| field.name() == quantity);
        if !is_known {
            let near = crate::names::guesses(&quantity, None).first().map(|guess| guess.field.name());
            let near = near.map_or_else(String::new, |name| format!("did you mean `{name}`? "));
            let known = Field::ALL.map(Field::name).join(", ");
            return wrong(format!(
                "`{}` is no quantity: {near}known are {known} and {IGNORE}",
                quoted(&quantity)
            ));
        }
        let column = column.trim();
        // A heading that begins with a minus of its own has to be quoted.
        let (is_reversed, column) =
            column.strip_prefix('-').map_or((false, column), |rest| (true, rest.trim()));
        let column = column.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(column);
        if column.is_empty() {
            return wrong(format!("`{quantity}` has no column: write such as `{quantity}=NAME [UNIT]`"));
        }
        let unit = column.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let unit = unit.map(|(_, unit)| unit.trim().to_owned());
        let twice = |entry: &&ColumnEntry| quantity != IGNORE && entry.quantity == quantity;
        if let Some(other) = self.0.iter().find(twice) {
            let other = quoted(&other.column);
            return wrong(format!("`{quantity}` is both `{other}` and `{}`: leave one out", quoted(column)));
        }
        if let Some(other) = self.0.iter().find(|entry| entry.column == column) {
            return wrong(format!(
                "the column `{}` is both `{}` and `{quantity}`: give each quantity a column of its own",
                quoted(column),
                other.quantity
            ));
        }
        self.0.push(ColumnEntry { quantity, column: column.to_owned(), unit, is_reversed });
        Ok(())
    }

    /// These entries, completed by those of another map for quantities and columns that these don't name.
    #[must_use]
    pub fn or(mut self, other: &Self) -> Self {
        let is_new = |entry: &&ColumnEntry| {
            self.0.iter().all(|own| {
                (own.quantity != entry.quantity || entry.quantity == IGNORE) && own.column != entry.column
            })
        };
        let more: Vec<ColumnEntry> = other.0.iter().filter(is_new).cloned().collect();
        self.0.extend(more);
        self
    }
}

/// The quantity of columns that aren't read.
pub(crate) const IGNORE: &str = "ignore";

impl std::str::FromStr for ColumnMap {
    type Err = MeasurementError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut found = Self::default();
        for part in parts(text) {
            let part = part.trim();
            if part.is_empty() {
                continue;
            }
            let Some((quantity, column)) = part.split_once('=') else {
                let what = format!("`{}` has no `=`: write such as `force=Force_N [N]`", quoted(part));
                return Err(MeasurementError::ColumnMap(what));
            };
            found.add(quantity, column)?;
        }
        if found.0.is_empty() {
            let what = "nothing is named: write such as `force=Force_N [N], pressure=P1 [psi]`".to_owned();
            return Err(MeasurementError::ColumnMap(what));
        }
        Ok(found)
    }
}

/// The parts between commas outside brackets and quotes.
fn parts(text: &str) -> Vec<&str> {
    let (mut found, mut start, mut depth, mut is_quoted) = (Vec::new(), 0, 0_i32, false);
    for (at, c) in text.char_indices() {
        match c {
            '"' => is_quoted = !is_quoted,
            '[' | '(' if !is_quoted => depth += 1,
            ']' | ')' if !is_quoted => depth -= 1,
            ',' if !is_quoted && depth <= 0 => {
                found.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    found.push(&text[start..]);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_read_and_refused() {
        let map: ColumnMap =
            "force = -\"F, raw [N]\", pressure=P1 (a,b) [psi],ignore=3,ignore=x".parse().unwrap();
        let shown: Vec<_> = map
            .entries()
            .iter()
            .map(|e| (e.quantity.as_str(), e.column.as_str(), e.unit.as_deref(), e.is_reversed))
            .collect();
        assert_eq!(
            shown,
            [
                ("force", "F, raw [N]", Some("N"), true),
                ("pressure", "P1 (a,b) [psi]", Some("psi"), false),
                ("ignore", "3", None, false),
                ("ignore", "x", None, false)
            ]
        );
        for (text, part) in [
            ("force", "has no `=`"),
            ("", "nothing is named"),
            ("forse=F", "did you mean `force`?"),
            ("colour=F", "known are pressure"),
            ("force=", "has no column"),
            ("force=a,force=b", "both `a` and `b`"),
            ("force=a,pressure=a", "both `force` and `pressure`"),
        ] {
            let message = text.parse::<ColumnMap>().unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
        let file: ColumnMap = "force=a,time=b".parse().unwrap();
        let both = "force=c".parse::<ColumnMap>().unwrap().or(&file);
        assert_eq!(both.entries().iter().map(|e| e.column.as_str()).collect::<Vec<_>>(), ["c", "b"]);
    }
}
