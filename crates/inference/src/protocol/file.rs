//! Protocol files: TOML into a protocol, with the place and the cure for everything that is wrong.

use bulge_muscles::{Dimension, FileError, Force, Length, Pressure, Quantity, Ratio, UnitError, units};
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::protocol::bench::{Block, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors, Wrong};

/// Most bytes of a protocol file.
const MOST_BYTES: usize = 1 << 20;
/// How many characters of a mistaken text are shown.
const MOST_SHOWN: usize = 40;
/// Rows of a cycle, or of each pressure of a map, where neither the block nor an interval says how many.
const USUAL_ROWS: u32 = 50;

/// A protocol file with every key.
pub const PROTOCOL_EXAMPLE: &str = "\
rig = \"drawn\"                  # zero and gain errors within the muscle's [instruments]; default \"none\"
pause = \"10 s\"                 # between sweeps
# warming = \"5 K\"              # rise of the temperature over the whole test

[[block]]                      # one or more; each pressure is one sweep
pressures = [\"2 bar\", \"3 bar\", \"4 bar\", \"5 bar\"]
contraction = \"1 %..20 %\"
shape = \"loops\"                # or \"stairs\" (with `steps` and `hold`), or \"static\" (a grid without time)
wave = \"triangle\"              # or \"sine\"
cycles = 3
period = \"50 s\"                # of one cycle; or a mean speed: rate = \"0.8 %/s\"
rows = 50                      # of one cycle, or of each pressure of a static grid
repeats = 1
specimens = 1

[noise]                        # one standard deviation each
force = \"2 N\"                  # white; with `tails = 4` as Student's t with 4 degrees of freedom
correlated = \"1 N\"             # exponentially, over `correlation_time`
correlation_time = \"5 s\"
offset = \"0.5 N\"               # of each sweep
pressure = \"100 Pa\"
length = \"20 um\"

[sampling]                     # the smallest differences that the sensors show
force = \"0.1 N\"
pressure = \"10 Pa\"
length = \"10 um\"
# interval = \"0.5 s\"           # between rows, instead of `rows`
";

/// Keys of the tables, with an example of each.
const TOP: [(&str, &str); 6] = [
    ("rig", "rig = \"drawn\""),
    ("pause", "pause = \"10 s\""),
    ("warming", "warming = \"5 K\""),
    ("block", "[[block]]"),
    ("noise", "noise = { force = \"2 N\" }"),
    ("sampling", "sampling = { force = \"0.1 N\" }"),
];
const BLOCK: [(&str, &str); 12] = [
    ("pressures", "pressures = [\"2 bar\", \"3 bar\"]"),
    ("contraction", "contraction = \"1 %..20 %\""),
    ("shape", "shape = \"loops\""),
    ("wave", "wave = \"triangle\""),
    ("cycles", "cycles = 3"),
    ("period", "period = \"50 s\""),
    ("rate", "rate = \"0.8 %/s\""),
    ("rows", "rows = 50"),
    ("steps", "steps = 8"),
    ("hold", "hold = \"5 s\""),
    ("repeats", "repeats = 2"),
    ("specimens", "specimens = 3"),
];
const NOISE: [(&str, &str); 7] = [
    ("force", "force = \"2 N\""),
    ("tails", "tails = 4"),
    ("correlated", "correlated = \"1 N\""),
    ("correlation_time", "correlation_time = \"5 s\""),
    ("offset", "offset = \"1 N\""),
    ("pressure", "pressure = \"100 Pa\""),
    ("length", "length = \"20 um\""),
];
const SAMPLING: [(&str, &str); 4] = [
    ("force", "force = \"0.1 N\""),
    ("pressure", "pressure = \"10 Pa\""),
    ("length", "length = \"10 um\""),
    ("interval", "interval = \"0.5 s\""),
];

/// The shapes of the motion in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Loops,
    Stairs,
    Static,
}

/// One table, with its place and its keys.
struct Table<'a> {
    origin: &'a str,
    text: &'a str,
    title: &'static str,
    span: Range<usize>,
    entries: &'a DeTable<'a>,
    keys: &'static [(&'static str, &'static str)],
}

impl Protocol {
    /// Reads a protocol file; [`PROTOCOL_EXAMPLE`] has every key.
    ///
    /// # Errors
    /// If the file can't be read, is larger than 1 MiB, is not UTF-8 or is no valid protocol. The message is complete.
    pub fn read(path: impl AsRef<std::path::Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let origin = path.display().to_string();
        let failed =
            |what: String| FileError::whole(&origin, what, "name a protocol file, such as `protocol.toml`");
        if path.is_dir() {
            return Err(failed("this is a folder, not a protocol file".to_owned()));
        }
        let unreadable = |error: std::io::Error| failed(format!("the file cannot be read: {error}"));
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let instead = "save the file as plain text with the encoding UTF-8";
            let what = format!("byte {} is not UTF-8 text", error.utf8_error().valid_up_to());
            FileError::whole(&origin, what, instead)
        })?;
        Self::from_toml(&text, &origin)
    }

    /// Reads a protocol from TOML text; `origin` is what messages call the text, usually a file name.
    ///
    /// ```
    /// use bulge_inference::{PROTOCOL_EXAMPLE, Protocol};
    /// let protocol = Protocol::from_toml(PROTOCOL_EXAMPLE, "protocol.toml")?;
    /// assert_eq!((protocol.len(), protocol.noise.force_n), (600, 2.0));
    /// let error = Protocol::from_toml(&PROTOCOL_EXAMPLE.replace("cycles", "cicles"), "protocol.toml").unwrap_err();
    /// assert_eq!((error.line(), error.instead()), (Some(10), "did you mean `cycles`?"));
    /// # Ok::<(), bulge_muscles::FileError>(())
    /// ```
    ///
    /// # Errors
    /// With the place and the cure, if the text is no valid protocol.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, FileError> {
        if text.len() > MOST_BYTES {
            let what = "the file is larger than 1 MiB, so it is no protocol";
            return Err(FileError::whole(origin, what, "name a protocol file: some ten lines of TOML"));
        }
        let root = DeTable::parse(text).map_err(|error| {
            let message = error.message().lines().collect::<Vec<_>>().join(", ");
            let instead = "each line is `key = value`, a `[table]` or a `# comment`; numbers with a unit stand in quotes: `period = \"50 s\"`";
            FileError::at(origin, text, error.span().unwrap_or(0..0), format!("this is not TOML: {message}"), instead)
        })?;
        let entries = root.get_ref();
        Table { origin, text, title: "the protocol", span: 0..0, entries, keys: &TOP }.protocol()
    }
}

impl<'a> Table<'a> {
    fn protocol(&self) -> Result<Protocol, FileError> {
        self.check_keys()?;
        let sampling = self.table("sampling", "`[sampling]`", &SAMPLING)?;
        let noise = self.table("noise", "`[noise]`", &NOISE)?;
        let interval = sampling.as_ref().map(Table::interval).transpose()?.flatten();
        let tables = self.blocks()?;
        let blocks = tables.iter().map(|table| table.block(interval)).collect::<Result<Vec<_>, _>>()?;
        let mut protocol = Protocol::new(blocks);
        if let Some(table) = &sampling {
            protocol.steps = table.steps()?;
        }
        if let Some(table) = &noise {
            protocol.noise = table.noise(protocol.is_static())?;
        }
        let rigs = [("none", RigErrors::None), ("drawn", RigErrors::Drawn)];
        protocol.rig = self.word("rig", &rigs)?.unwrap_or_default();
        if let Some(pause) = self.quantity("pause", Dimension::TIME)? {
            protocol.pause_s = pause;
        }
        protocol.warming_k = self.quantity("warming", Dimension::TEMPERATURE)?.unwrap_or(0.0);
        protocol.check_whole().map_err(|wrong| self.wrong(wrong))?;
        Ok(protocol)
    }

    fn blocks(&self) -> Result<Vec<Table<'a>>, FileError> {
        let Some(value) = self.get("block") else { return Err(self.missing("block")) };
        let refused = || self.wrong_type("block", value, "an array of tables");
        let DeValue::Array(items) = value.get_ref() else { return Err(refused()) };
        let one = |item: &'a Spanned<DeValue<'a>>| {
            let DeValue::Table(entries) = item.get_ref() else { return Err(refused()) };
            Ok(Table { title: "this `[[block]]`", span: item.span(), entries, keys: &BLOCK, ..*self })
        };
        items.iter().map(one).collect()
    }

    fn block(&self, interval: Option<f64>) -> Result<Block, FileError> {
        self.check_keys()?;
        let shapes = [("loops", Shape::Loops), ("stairs", Shape::Stairs), ("static", Shape::Static)];
        let shape = self.word("shape", &shapes)?.unwrap_or(Shape::Loops);
        self.check_shape(shape)?;
        let mut block = Block::loops(self.pressures()?, self.range()?, 0.0);
        block.repeats = self.count("repeats")?.unwrap_or(1);
        block.specimens = self.count("specimens")?.unwrap_or(1);
        block.cycles = self.count("cycles")?.unwrap_or(1);
        block.path = match shape {
            Shape::Static => Path::Static,
            Shape::Loops => {
                let waves = [("triangle", Path::Triangle), ("sine", Path::Sine)];
                self.word("wave", &waves)?.unwrap_or(Path::Triangle)
            }
            Shape::Stairs => Path::Stairs {
                steps: self.count("steps")?.unwrap_or(8),
                hold_s: self.quantity("hold", Dimension::TIME)?.ok_or_else(|| self.missing("hold"))?,
            },
        };
        if shape != Shape::Static {
            block.period_s = self.period(&block)?;
        }
        let stated = self.count("rows")?;
        block.rows = match interval.filter(|_| shape != Shape::Static && stated.is_none()) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and 1e9")]
            Some(interval) => (block.period_s / interval).round().clamp(0.0, 1e9) as u32,
            None => stated.unwrap_or(USUAL_ROWS),
        };
        block.check().map_err(|wrong| self.wrong(wrong))?;
        Ok(block)
    }

    /// Refuses keys that mean nothing for the shape.
    fn check_shape(&self, shape: Shape) -> Result<(), FileError> {
        let strange: &[&str] = match shape {
            Shape::Loops => &["steps", "hold"],
            Shape::Stairs => &["wave"],
            Shape::Static => &["wave", "cycles", "period", "rate", "steps", "hold"],
        };
        let Some(key) = strange.iter().find(|key| self.get(key).is_some()) else { return Ok(()) };
        let what = format!("`{key}` means nothing for this shape of the motion");
        Err(self.error(self.key_span(key), what, format!("delete `{key}`, or write another `shape`")))
    }

    /// The period, or that of a mean speed: of the whole way in loops, of the steps between the holds in stairs.
    fn period(&self, block: &Block) -> Result<f64, FileError> {
        let period = self.quantity("period", Dimension::TIME)?;
        let Some(rate) = self.quantity("rate", Dimension::RATE)? else {
            return period.ok_or_else(|| self.missing("period"));
        };
        if period.is_some() {
            let what = "`period` and `rate` say the same twice";
            return Err(self.error(self.key_span("rate"), what, "delete one of the two"));
        }
        if rate <= 0.0 {
            let what = format!("a rate of {rate} 1/s is not possible: it must be > 0");
            return Err(self.error(self.value_span("rate"), what, "write such as `rate = \"0.8 %/s\"`"));
        }
        let moving = 2.0 * (block.contraction[1] - block.contraction[0]) / rate;
        let Path::Stairs { steps, hold_s } = block.path else { return Ok(moving) };
        Ok(moving + 2.0 * f64::from(steps) * hold_s)
    }

    fn pressures(&self) -> Result<Vec<f64>, FileError> {
        let Some(value) = self.get("pressures") else { return Err(self.missing("pressures")) };
        let si = |list: Vec<Pressure>| list.into_iter().map(Quantity::si).collect();
        match value.get_ref() {
            DeValue::String(text) => {
                units::parse_list(text).map(si).map_err(|error| self.unit("pressures", value, &error))
            }
            DeValue::Array(items) => items
                .iter()
                .map(|item| {
                    let text = number_text(item.get_ref()).ok_or_else(|| {
                        self.wrong_type("pressures", item, "a list of pressures with their units")
                    })?;
                    let pressure = units::parse::<Pressure>(text);
                    pressure.map(Quantity::si).map_err(|error| self.unit("pressures", item, &error))
                })
                .collect(),
            _ => Err(self.wrong_type("pressures", value, "a list of pressures with their units")),
        }
    }

    fn range(&self) -> Result<[f64; 2], FileError> {
        let Some(value) = self.get("contraction") else { return Err(self.missing("contraction")) };
        let DeValue::String(text) = value.get_ref() else {
            return Err(self.wrong_type("contraction", value, "a range in quotes"));
        };
        let range = units::parse_range::<Ratio>(text);
        range
            .map(|(low, high)| [low.si(), high.si()])
            .map_err(|error| self.unit("contraction", value, &error))
    }

    fn interval(&self) -> Result<Option<f64>, FileError> {
        self.check_keys()?;
        let interval = self.quantity("interval", Dimension::TIME)?;
        if let Some(interval) = interval.filter(|interval| *interval <= 0.0) {
            let what = format!("an interval of {interval} s is not possible: it must be > 0 s");
            return Err(self.error(
                self.value_span("interval"),
                what,
                "write such as `interval = \"0.5 s\"`",
            ));
        }
        Ok(interval)
    }

    fn steps(&self) -> Result<ReadingSteps, FileError> {
        let steps = ReadingSteps {
            force_n: self.size::<Force>("force")?,
            pressure_pa: self.size::<Pressure>("pressure")?,
            length_m: self.size::<Length>("length")?,
        };
        steps.check().map_err(|wrong| self.wrong(wrong))?;
        Ok(steps)
    }

    fn noise(&self, is_static: bool) -> Result<ReadingNoise, FileError> {
        self.check_keys()?;
        let noise = ReadingNoise {
            force_n: self.size::<Force>("force")?,
            tails: self.quantity("tails", Dimension::NONE)?,
            correlated_n: self.size::<Force>("correlated")?,
            correlation_time_s: self.quantity("correlation_time", Dimension::TIME)?.unwrap_or(0.0),
            offset_n: self.size::<Force>("offset")?,
            pressure_pa: self.size::<Pressure>("pressure")?,
            length_m: self.size::<Length>("length")?,
        };
        noise.check(is_static).map_err(|wrong| self.wrong(wrong))?;
        Ok(noise)
    }

    /// A quantity in SI; 0 if it is absent.
    fn size<Q: Quantity>(&self, name: &'static str) -> Result<f64, FileError> {
        let Some(value) = self.get(name) else { return Ok(0.0) };
        let text = self.number(name, value)?;
        units::parse::<Q>(text).map(Quantity::si).map_err(|error| self.unit(name, value, &error))
    }

    /// A quantity of a dimension in SI.
    fn quantity(&self, name: &'static str, dimension: Dimension) -> Result<Option<f64>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let found = units::any(self.number(name, value)?)
            .map_err(|error| self.error(value.span(), error.to_string(), self.write(name)))?;
        if found.dimension == dimension {
            return Ok(Some(found.si));
        }
        let what =
            format!("`{name}` is {}, but must be {}", found.dimension.describe(), dimension.describe());
        Err(self.error(value.span(), what, self.write(name)))
    }

    fn number(&self, name: &str, value: &'a Spanned<DeValue<'a>>) -> Result<&'a str, FileError> {
        number_text(value.get_ref())
            .ok_or_else(|| self.wrong_type(name, value, "text with a number and a unit"))
    }

    fn count(&self, name: &str) -> Result<Option<u32>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let whole = match value.get_ref() {
            DeValue::Integer(number) => u32::from_str_radix(number.as_str(), number.radix()).ok(),
            _ => None,
        };
        let refused = || self.wrong_type(name, value, "a whole number, 1 or more");
        whole.map(Some).ok_or_else(refused)
    }

    /// One word of a list.
    fn word<T: Copy>(&self, name: &str, known: &[(&'static str, T)]) -> Result<Option<T>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let DeValue::String(text) = value.get_ref() else {
            return Err(self.wrong_type(name, value, "text in quotes"));
        };
        if let Some((_, found)) = known.iter().find(|(word, _)| word == text) {
            return Ok(Some(*found));
        }
        let words: Vec<&'static str> = known.iter().map(|(word, _)| *word).collect();
        let near = nearest(text, words.iter().copied()).unwrap_or(words[0]);
        let what = format!("`{name}` is \"{}\", but must be one of: {}", shortened(text), words.join(", "));
        Err(self.error(value.span(), what, format!("write `{name} = \"{near}\"`")))
    }

    fn table(
        &self,
        name: &str,
        title: &'static str,
        keys: &'static [(&'static str, &'static str)],
    ) -> Result<Option<Table<'a>>, FileError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let DeValue::Table(entries) = value.get_ref() else {
            return Err(self.wrong_type(name, value, "a table"));
        };
        Ok(Some(Table { title, span: value.span(), entries, keys, ..*self }))
    }

    fn get(&self, name: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
    }

    fn check_keys(&self) -> Result<(), FileError> {
        let mut names: Vec<_> = self.entries.keys().map(|key| (key.get_ref().as_ref(), key.span())).collect();
        names.sort_by_key(|(_, span): &(&str, _)| span.start);
        let known = || self.keys.iter().map(|(key, _)| *key);
        let Some((name, span)) = names.into_iter().find(|(name, _)| known().all(|key| key != *name)) else {
            return Ok(());
        };
        let instead = nearest(name, known()).map_or_else(
            || {
                format!(
                    "known here: {}; leave the rest out, or write it behind a `#`",
                    known().collect::<Vec<_>>().join(", ")
                )
            },
            |near| format!("did you mean `{near}`?"),
        );
        Err(self.error(span, format!("unknown key `{}` in {}", shortened(name), self.title), instead))
    }

    /// The place of a key, or of the table where it is absent.
    fn key_span(&self, name: &str) -> Range<usize> {
        let key = self.entries.keys().find(|key| key.get_ref() == name);
        key.map_or_else(|| self.span.clone(), Spanned::span)
    }

    fn value_span(&self, name: &str) -> Range<usize> {
        self.get(name).map_or_else(|| self.span.clone(), Spanned::span)
    }

    fn error(&self, span: Range<usize>, what: impl Into<String>, instead: impl Into<String>) -> FileError {
        FileError::at(self.origin, self.text, span, what, instead)
    }

    /// A number out of range, at its place.
    fn wrong(&self, wrong: Wrong) -> FileError {
        self.error(self.value_span(wrong.key), wrong.what, wrong.instead)
    }

    fn unit(&self, name: &str, value: &Spanned<DeValue<'_>>, error: &UnitError) -> FileError {
        self.error(value.span(), error.to_string(), self.write(name))
    }

    fn write(&self, name: &str) -> String {
        let example = self.keys.iter().find(|(key, _)| *key == name).map_or("", |(_, example)| example);
        format!("write such as `{example}`")
    }

    fn missing(&self, name: &str) -> FileError {
        let what = format!("{} needs `{name}`, which is missing", self.title);
        self.error(self.span.clone(), what, self.write(name).replacen("write", "add", 1))
    }

    fn wrong_type(&self, name: &str, value: &Spanned<DeValue<'_>>, wanted: &str) -> FileError {
        let found = match value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        self.error(value.span(), format!("`{name}` is {found}, but must be {wanted}"), self.write(name))
    }
}

/// A number with its unit; a bare number goes the same way, and the message says which unit is missing.
fn number_text<'a>(value: &'a DeValue<'a>) -> Option<&'a str> {
    match value {
        DeValue::String(text) => Some(text.as_ref()),
        DeValue::Integer(number) => Some(number.as_str()),
        DeValue::Float(number) => Some(number.as_str()),
        _ => None,
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(MOST_SHOWN).collect()
}

/// The name that was probably meant: a slip or two away.
fn nearest(word: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let word = word.to_lowercase().replace(['-', ' '], "_");
    let slips = |name: &str| strsim::damerau_levenshtein(name, &word);
    names.min_by_key(|name| slips(name)).filter(|name| slips(name) <= word.chars().count().div_ceil(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: &str =
        "[[block]]\npressures = \"2,3 bar\"\ncontraction = \"1 %..15 %\"\nperiod = \"40 s\"\n";

    fn read(text: &str) -> Protocol {
        Protocol::from_toml(text, "p.toml").unwrap()
    }

    #[test]
    fn every_key_is_read() {
        let text = PROTOCOL_EXAMPLE.replace("# warming", "warming").replace("# interval", "interval");
        let found = read(&text.replace("force = \"2 N\"", "tails = 4\nforce = \"2 N\""));
        assert_eq!((found.rig, found.pause_s, found.warming_k), (RigErrors::Drawn, 10.0, 5.0));
        let block = &found.blocks[0];
        assert_eq!(block.pressures_pa, [2e5, 3e5, 4e5, 5e5]);
        assert_eq!((block.contraction, block.path), ([0.01, 0.2], Path::Triangle));
        assert_eq!((block.cycles, block.period_s, block.rows), (3, 50.0, 50));
        assert_eq!((block.repeats, block.specimens, found.len()), (1, 1, 600));
        let noise = ReadingNoise {
            force_n: 2.0,
            tails: Some(4.0),
            correlated_n: 1.0,
            correlation_time_s: 5.0,
            offset_n: 0.5,
            pressure_pa: 100.0,
            length_m: 20e-6,
        };
        assert_eq!(found.noise, noise);
        assert_eq!(found.steps, ReadingSteps { force_n: 0.1, pressure_pa: 10.0, length_m: 10e-6 });
        // Every key of the lists is in the example, in a comment at least.
        for (key, _) in TOP.iter().chain(&BLOCK).chain(&NOISE).chain(&SAMPLING) {
            assert!(PROTOCOL_EXAMPLE.contains(key), "{key}");
        }
    }

    #[test]
    fn shapes_and_ways_of_stating_time() {
        let short = read(SHORT);
        assert_eq!(
            (short.blocks[0].pressures_pa.as_slice(), short.blocks[0].rows),
            ([2e5, 3e5].as_slice(), 50)
        );
        assert_eq!((short.rig, short.noise, short.pause_s), (RigErrors::None, ReadingNoise::default(), 10.0));
        // Up and down over 14 % at 0.5 %/s.
        let rate =
            read(&SHORT.replace(
                "period = \"40 s\"",
                "rate = \"0.5 %/s\"\nwave = \"sine\"\nrepeats = 2\nspecimens = 3",
            ));
        assert!((rate.blocks[0].period_s - 56.0).abs() < 1e-9);
        assert_eq!((rate.blocks[0].path, rate.len()), (Path::Sine, 600));
        let interval = read(&format!("{SHORT}[sampling]\ninterval = \"0.1 s\"\n"));
        assert_eq!(interval.blocks[0].rows, 400);
        let stairs = "shape = \"stairs\"\nsteps = 7\nhold = \"5 s\"\nrate = \"2 %/s\"";
        let stairs = read(&SHORT.replace("period = \"40 s\"", stairs));
        assert_eq!(stairs.blocks[0].path, Path::Stairs { steps: 7, hold_s: 5.0 });
        assert!((stairs.blocks[0].period_s - 84.0).abs() < 1e-9);
        let map = read(&SHORT.replace("period = \"40 s\"", "shape = \"static\"\nrows = 12"));
        assert_eq!((map.blocks[0].path, map.len(), map.is_static()), (Path::Static, 24, true));
    }

    #[test]
    fn mistakes_are_named_with_place_and_cure() {
        let with = |line: &str| SHORT.replace("period = \"40 s\"", line);
        for (text, parts) in [
            (String::new(), ["p.toml:1:1", "needs `block`", "`[[block]]`"]),
            (SHORT.replace("[[block]]", "[block]"), ["p.toml:1:", "array of tables", "`[[block]]`"]),
            (
                SHORT.replace("pressures", "presures"),
                ["p.toml:2:1", "unknown key `presures`", "did you mean `pressures`?"],
            ),
            (SHORT.replace("2,3 bar", "2,3 mm"), ["p.toml:2:13", "mm", "pressures = [\"2 bar\""]),
            (SHORT.replace("\"2,3 bar\"", "[\"2 bar\", 3]"), ["p.toml:2:23", "`3` has no unit", "2 bar"]),
            (SHORT.replace("2,3 bar", "2,-3 bar"), ["p.toml:2:13", "-300000 Pa", "2 bar"]),
            (SHORT.replace("\"2,3 bar\"", "[]"), ["p.toml:2:13", "0 pressures", "pressures = "]),
            (SHORT.replace("1 %..15 %", "15 %..1 %"), ["p.toml:3:15", "must rise", "1 %..20 %"]),
            (SHORT.replace("1 %..15 %", "1 %"), ["p.toml:3:15", "1 %", "1 %..20 %"]),
            (with(""), ["p.toml:1:1", "needs `period`", "add such as `period = \"50 s\"`"]),
            (with("period = 40"), ["p.toml:4:10", "a pure number, but must be a time", "50 s"]),
            (with("period = \"-4 s\""), ["p.toml:4:10", "-4 s", "50 s"]),
            (with("period = \"4 s\"\nrate = \"1 %/s\""), ["p.toml:5:1", "twice", "delete one"]),
            (with("rate = \"0 %/s\""), ["p.toml:4:8", "> 0", "0.8 %/s"]),
            (with("period = \"9 s\"\ncycles = 0"), ["p.toml:5:10", "`cycles` is 0", "cycles = 3"]),
            (with("period = \"9 s\"\nrows = 2.5"), ["p.toml:5:8", "a whole number", "rows = 50"]),
            (
                with("period = \"9 s\"\nshape = \"loop\""),
                ["p.toml:5:9", "loops, stairs, static", "shape = \"loops\""],
            ),
            (with("period = \"9 s\"\nhold = \"1 s\""), ["p.toml:5:1", "means nothing", "delete `hold`"]),
            (
                with("period = \"9 s\"\nshape = \"stairs\"\nhold = \"5 s\""),
                ["p.toml:6:8", "a hold of 5 s", "shorter"],
            ),
            (
                with("shape = \"static\"\n[noise]\ncorrelated = \"1 N\""),
                ["p.toml:6:14", "needs time", "leave it out"],
            ),
            (format!("{SHORT}[noise]\nforce = \"2 mm\""), ["p.toml:6:9", "2 mm", "force = \"2 N\""]),
            (format!("{SHORT}[noise]\nforce = \"-2 N\""), ["p.toml:6:9", "standard deviation", "2 N"]),
            (format!("{SHORT}[noise]\ncorrelated = \"2 N\""), ["p.toml:5:", "correlation time", "5 s"]),
            (format!("{SHORT}[noise]\ntails = 2"), ["p.toml:6:9", "`tails` is 2", "tails = 4"]),
            (format!("{SHORT}[sampling]\ninterval = \"0 s\""), ["p.toml:6:12", "> 0 s", "0.5 s"]),
            (format!("rig = \"draw\"\n{SHORT}"), ["p.toml:1:7", "none, drawn", "rig = \"drawn\""]),
            (format!("warming = \"5 N\"\n{SHORT}"), ["p.toml:1:11", "a temperature", "5 K"]),
            (with("period = \"9 s\"\ncycles = 9000\nrepeats = 9"), ["p.toml:", "8100000 rows", "fewer"]),
            ("x = 40 s".to_owned(), ["p.toml:1:", "not TOML", "in quotes"]),
        ] {
            let message = Protocol::from_toml(&text, "p.toml").unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{message:?} does not say {part:?}");
            }
        }
        let mixed = format!("{SHORT}{}", with("shape = \"static\""));
        assert!(Protocol::from_toml(&mixed, "p").unwrap_err().what().contains("don't fit into one file"));
        assert!(Protocol::read("no/such/protocol.toml").unwrap_err().what().contains("cannot be read"));
    }
}
