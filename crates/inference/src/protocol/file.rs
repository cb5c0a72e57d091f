//! Protocol files: parses TOML into a protocol. Every error has its place and its remedy.

use bulge_muscles::settings::{Document, FileKind, Setting, Settings};
use bulge_muscles::{Dimension, FileError, Force, Length, Pressure, Quantity, Ratio, units};

use crate::protocol::bench::{Block, Path, Protocol, ReadingNoise, ReadingSteps, RigErrors, Wrong};

/// Name of the file in messages.
const KIND: FileKind = FileKind { name: "protocol", file: "protocol.toml", line: "period = \"50 s\"" };
/// Rows of a cycle, or of each pressure of a map, if neither the block nor a sampling interval states them.
const USUAL_ROWS: u32 = 50;

/// A protocol file with every key.
pub const PROTOCOL_EXAMPLE: &str = "\
rig = \"none\"                   # or \"drawn\": zero and gain errors within the [instruments] that the muscle file states
pause = \"10 s\"                 # between sweeps
# warming = \"5 K\"              # rise of the temperature over the whole test

[[block]]                      # one or more; each pressure is one sweep
pressures = [\"2 bar\", \"3 bar\", \"4 bar\", \"5 bar\"]
contraction = \"1 %..20 %\"
shape = \"loops\"                # or \"stairs\" (with `steps` and `hold`), \"static\" (a grid without time), or \"isometric\"
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

# [[block]]                    # filling and venting at held lengths
# shape = \"isometric\"
# contractions = [\"2 %\", \"10 %\"]
# pressure = \"1 bar..6 bar\"
# period = \"20 s\"
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
const BLOCK: [(&str, &str); 14] = [
    ("pressures", "pressures = [\"2 bar\", \"3 bar\"]"),
    ("contraction", "contraction = \"1 %..20 %\""),
    ("contractions", "contractions = [\"2 %\", \"10 %\"]"),
    ("pressure", "pressure = \"1 bar..6 bar\""),
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

/// Shapes of the motion in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Loops,
    Stairs,
    Static,
    Isometric,
}

impl Protocol {
    /// Reads a protocol file; [`PROTOCOL_EXAMPLE`] has every key.
    ///
    /// # Errors
    /// If the file can't be read, is larger than 1 MiB, is not UTF-8, or is no valid protocol. The message is
    /// complete.
    pub fn read(path: impl AsRef<std::path::Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let (text, origin) = (KIND.read(path)?, path.display().to_string());
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
    /// If the text is no valid protocol; the error has the place and the remedy.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, FileError> {
        protocol(&Document::parse(KIND, text, origin)?.settings("the protocol", &TOP))
    }
}

fn protocol(settings: &Settings<'_>) -> Result<Protocol, FileError> {
    settings.check_keys()?;
    let sampling = settings.table("sampling", "`[sampling]`", &SAMPLING)?;
    let noises = settings.table("noise", "`[noise]`", &NOISE)?;
    let interval = sampling.as_ref().map(interval).transpose()?.flatten();
    let tables = settings.tables("block", "this `[[block]]`", &BLOCK)?;
    let tables = tables.ok_or_else(|| settings.missing("block"))?;
    let blocks = tables.iter().map(|table| block(table, interval)).collect::<Result<Vec<_>, _>>()?;
    let mut protocol = Protocol::new(blocks);
    if let Some(table) = &sampling {
        protocol.steps = steps(table)?;
    }
    if let Some(table) = &noises {
        protocol.noise = noise(table, protocol.is_static())?;
    }
    let rigs = [("none", RigErrors::None), ("drawn", RigErrors::Drawn)];
    protocol.rig = settings.word("rig", &rigs)?.unwrap_or_default();
    if let Some(pause) = settings.quantity("pause", Dimension::TIME)? {
        protocol.pause_s = pause;
    }
    protocol.warming_k = settings.quantity("warming", Dimension::TEMPERATURE)?.unwrap_or(0.0);
    protocol.check_whole().map_err(|wrong| out_of_range(settings, &wrong))?;
    Ok(protocol)
}

fn block(settings: &Settings<'_>, interval: Option<f64>) -> Result<Block, FileError> {
    settings.check_keys()?;
    let shapes = [
        ("loops", Shape::Loops),
        ("stairs", Shape::Stairs),
        ("static", Shape::Static),
        ("isometric", Shape::Isometric),
    ];
    let shape = settings.word("shape", &shapes)?.unwrap_or(Shape::Loops);
    check_shape(settings, shape)?;
    let mut block = if shape == Shape::Isometric {
        let [low, high] = range::<Pressure>(settings, "pressure")?;
        Block::isometric(
            [low, high],
            list::<Ratio>(settings, "contractions", "a list of contractions with their units")?,
            0.0,
        )
    } else {
        let pressures = list::<Pressure>(settings, "pressures", "a list of pressures with their units")?;
        Block::loops(pressures, range::<Ratio>(settings, "contraction")?, 0.0)
    };
    block.repeats = settings.count("repeats")?.unwrap_or(1);
    block.specimens = settings.count("specimens")?.unwrap_or(1);
    block.cycles = settings.count("cycles")?.unwrap_or(1);
    block.path = match shape {
        Shape::Static => Path::Static,
        Shape::Loops | Shape::Isometric => {
            let waves = [("triangle", Path::Triangle), ("sine", Path::Sine)];
            settings.word("wave", &waves)?.unwrap_or(Path::Triangle)
        }
        Shape::Stairs => Path::Stairs {
            steps: settings.count("steps")?.unwrap_or(8),
            hold_s: settings.quantity("hold", Dimension::TIME)?.ok_or_else(|| settings.missing("hold"))?,
        },
    };
    if shape != Shape::Static {
        block.period_s = period(settings, &block)?;
    }
    let stated = settings.count("rows")?;
    block.rows = match interval.filter(|_| shape != Shape::Static && stated.is_none()) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and 1e9")]
        Some(interval) => (block.period_s / interval).round().clamp(0.0, 1e9) as u32,
        None => stated.unwrap_or(USUAL_ROWS),
    };
    block.check().map_err(|wrong| out_of_range(settings, &wrong))?;
    Ok(block)
}

/// Refuses keys that have no meaning for the shape.
fn check_shape(settings: &Settings<'_>, shape: Shape) -> Result<(), FileError> {
    let strange: &[&str] = match shape {
        Shape::Loops => &["steps", "hold", "contractions", "pressure"],
        Shape::Stairs => &["wave", "contractions", "pressure"],
        Shape::Static => &["wave", "cycles", "period", "rate", "steps", "hold", "contractions", "pressure"],
        Shape::Isometric => &["steps", "hold", "rate", "contraction", "pressures"],
    };
    let Some(key) = strange.iter().find(|key| settings.get(key).is_some()) else { return Ok(()) };
    let what = format!("`{key}` means nothing for this shape of the motion");
    Err(settings.error(settings.key_span(key), what, format!("delete `{key}`, or write another `shape`")))
}

/// The period, stated directly or through a mean speed: over the whole way in loops, over the steps between
/// the holds in stairs.
fn period(settings: &Settings<'_>, block: &Block) -> Result<f64, FileError> {
    let period = settings.quantity("period", Dimension::TIME)?;
    let Some(rate) = settings.quantity("rate", Dimension::RATE)? else {
        return period.ok_or_else(|| settings.missing("period"));
    };
    if period.is_some() {
        let what = "`period` and `rate` say the same twice";
        return Err(settings.error(settings.key_span("rate"), what, "delete one of the two"));
    }
    if rate <= 0.0 {
        let what = format!("a rate of {rate} 1/s is not possible: it must be > 0");
        return Err(settings.error(settings.value_span("rate"), what, "write such as `rate = \"0.8 %/s\"`"));
    }
    let moving = 2.0 * (block.contraction[1] - block.contraction[0]) / rate;
    let Path::Stairs { steps, hold_s } = block.path else { return Ok(moving) };
    Ok(moving + 2.0 * f64::from(steps) * hold_s)
}

/// A list of quantities in SI, written as one text or as several.
fn list<Q: Quantity>(settings: &Settings<'_>, key: &'static str, what: &str) -> Result<Vec<f64>, FileError> {
    let Some(value) = settings.get(key) else { return Err(settings.missing(key)) };
    if let Some(text) = value.text() {
        let list = units::parse_list::<Q>(text);
        return list
            .map(|list| list.into_iter().map(Quantity::si).collect())
            .map_err(|error| settings.unreadable(key, value, error));
    }
    let refused = |value: Setting<'_>| settings.wrong_type(key, value, what);
    let items = value.items().ok_or_else(|| refused(value))?;
    let one = |item: Setting<'_>| {
        let text = item.number().ok_or_else(|| refused(item))?;
        let quantity = units::parse::<Q>(text);
        quantity.map(Quantity::si).map_err(|error| settings.unreadable(key, item, error))
    };
    items.into_iter().map(one).collect()
}

fn range<Q: Quantity>(settings: &Settings<'_>, key: &'static str) -> Result<[f64; 2], FileError> {
    let Some(value) = settings.get(key) else { return Err(settings.missing(key)) };
    let Some(text) = value.text() else {
        return Err(settings.wrong_type(key, value, "a range in quotes"));
    };
    let range = units::parse_range::<Q>(text);
    range.map(|(low, high)| [low.si(), high.si()]).map_err(|error| settings.unreadable(key, value, error))
}

fn interval(settings: &Settings<'_>) -> Result<Option<f64>, FileError> {
    settings.check_keys()?;
    let interval = settings.quantity("interval", Dimension::TIME)?;
    if let Some(interval) = interval.filter(|interval| *interval <= 0.0) {
        let what = format!("an interval of {interval} s is not possible: it must be > 0 s");
        return Err(settings.error(
            settings.value_span("interval"),
            what,
            "write such as `interval = \"0.5 s\"`",
        ));
    }
    Ok(interval)
}

fn steps(settings: &Settings<'_>) -> Result<ReadingSteps, FileError> {
    let steps = ReadingSteps {
        force_n: settings.size::<Force>("force")?,
        pressure_pa: settings.size::<Pressure>("pressure")?,
        length_m: settings.size::<Length>("length")?,
    };
    steps.check().map_err(|wrong| out_of_range(settings, &wrong))?;
    Ok(steps)
}

fn noise(settings: &Settings<'_>, is_static: bool) -> Result<ReadingNoise, FileError> {
    settings.check_keys()?;
    let noise = ReadingNoise {
        force_n: settings.size::<Force>("force")?,
        tails: settings.quantity("tails", Dimension::NONE)?,
        correlated_n: settings.size::<Force>("correlated")?,
        correlation_time_s: settings.quantity("correlation_time", Dimension::TIME)?.unwrap_or(0.0),
        offset_n: settings.size::<Force>("offset")?,
        pressure_pa: settings.size::<Pressure>("pressure")?,
        length_m: settings.size::<Length>("length")?,
    };
    noise.check(is_static).map_err(|wrong| out_of_range(settings, &wrong))?;
    Ok(noise)
}

/// The error for a number out of range, at its place.
fn out_of_range(settings: &Settings<'_>, wrong: &Wrong) -> FileError {
    settings.error(settings.value_span(wrong.key), wrong.what.clone(), wrong.instead.clone())
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
        let text = text.replace("rig = \"none\" ", "rig = \"drawn\" ");
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
        // Every key of the lists appears in the example, if only in a comment.
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
        assert!(
            Protocol::read("no/such/protocol.toml").unwrap_err().what().contains("there is no such file")
        );
    }
}
