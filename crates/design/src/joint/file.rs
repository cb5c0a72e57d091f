//! Joint files: reads TOML into a joint. Every error states the place of the mistake and how to correct it.

use bulge_effects::{Catalogue, known};
use bulge_fibre::Approach;
use bulge_muscles::settings::{Document, FileKind, Keys, Settings};
use bulge_muscles::{Angle, Dimension, FileError, Length, Pressure, Quantity, units};
use std::f64::consts::PI;
use std::path::Path;

use super::{FourBar, Joint, JointMuscle, Linkage, Side};

/// Name of the file in messages.
const KIND: FileKind = FileKind { name: "joint", file: "joint.toml", line: "radius = \"40 mm\"" };

/// A joint file with every key.
pub const JOINT_EXAMPLE: &str = "\
name = \"knee\"
muscle = \"ppam-2-r16\"           # both: a muscle file, beside this one, or a shipped muscle
# agonist = \"ppam-2-r16\"        # or each
# antagonist = \"ppam-2-r11\"
kind = \"pulley\"                 # or \"lever\"; or \"four-bar\", with the pulley or the lever on its crank
radius = \"40 mm\"                # of the pulley
# arm = \"40 mm\"                 # of a lever: from the joint's axis to the attachment on the moving link,
# base = \"150 mm\"               # to the attachment on the base,
# lever_angle = \"90 deg\"        # and the angle between both at the joint's angle 0; mirrored for the antagonist
# ground = \"100 mm\"             # of a four-bar linkage: from the crank's pivot to the joint's axis,
# crank = \"40 mm\"               # crank,
# coupler = \"90 mm\"             # coupler,
# rocker = \"50 mm\"              # from the joint's axis to the coupler's end on the moving link,
# rocker_angle = \"115 deg\"       # and its angle against the line from the crank's pivot through the joint's axis, at the angle 0
# crossed = false               # whether the coupler crosses that line
contraction = \"20 %\"            # of both muscles at the angle 0
# agonist_contraction = \"20 %\"  # or of each
# antagonist_contraction = \"18 %\"
angle = \"-25 deg..25 deg\"       # a positive angle shortens the agonist
pressure = \"0.5 bar..3 bar\"     # of both muscles
outputs = [\"torque\", \"stiffness\"] # also torque_agonist, torque_antagonist, contraction_agonist, contraction_antagonist

[table]                         # the binary table, if one is wanted
tolerance = 1e-4                # largest relative error of the values
gradient = 1e-2                 # and of their gradients
max_size = \"1 MiB\"
form = \"fastest\"                # or \"smallest\", \"splines\", \"chebyshev\"
checks = 131072                 # points off the grid that certify it
";

/// Keys of the file, each with an example.
const TOP: Keys = &[
    ("name", "name = \"knee\""),
    ("muscle", "muscle = \"ppam-2-r16\""),
    ("agonist", "agonist = \"ppam-2-r16\""),
    ("antagonist", "antagonist = \"ppam-2-r16\""),
    ("kind", "kind = \"pulley\""),
    ("radius", "radius = \"40 mm\""),
    ("arm", "arm = \"40 mm\""),
    ("base", "base = \"150 mm\""),
    ("lever_angle", "lever_angle = \"90 deg\""),
    ("ground", "ground = \"100 mm\""),
    ("crank", "crank = \"40 mm\""),
    ("coupler", "coupler = \"90 mm\""),
    ("rocker", "rocker = \"50 mm\""),
    ("rocker_angle", "rocker_angle = \"115 deg\""),
    ("crossed", "crossed = false"),
    ("contraction", "contraction = \"15 %\""),
    ("agonist_contraction", "agonist_contraction = \"15 %\""),
    ("antagonist_contraction", "antagonist_contraction = \"15 %\""),
    ("angle", "angle = \"-25 deg..25 deg\""),
    ("pressure", "pressure = \"0.5 bar..3 bar\""),
    ("outputs", "outputs = [\"torque\", \"stiffness\"]"),
    ("table", "[table]"),
];
/// Extent of the checks of a joint file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checks {
    /// Both muscles must pull over the whole of the ranges, as maps and tables require.
    Everywhere,
    /// Only the linkage is checked. Single angles and pressures are checked when they are used.
    Linkage,
}

impl Joint {
    /// Reads a joint file; [`JOINT_EXAMPLE`] shows every key. The muscle files that it names are looked up
    /// beside it. `more` reads other settings of the file, such as the outputs and the table that are
    /// requested.
    ///
    /// # Errors
    /// If the file can't be read, is larger than 1 MiB, is not UTF-8 or is no valid joint, or if a muscle
    /// can't be read. The message is complete.
    pub fn read<T>(
        path: &Path,
        checks: Checks,
        more: impl FnOnce(&Settings<'_>) -> Result<T, FileError>,
    ) -> Result<(Self, T), FileError> {
        Self::from_toml(&KIND.read(path)?, &path.display().to_string(), path.parent(), checks, more)
    }

    /// Reads a joint from TOML text. Messages call the text `origin`, usually a file name. The muscle files
    /// are looked up in `folder`, or in the current folder if none is given.
    ///
    /// ```
    /// use bulge_design::joint::{Checks, JOINT_EXAMPLE, Joint};
    /// let (joint, ()) = Joint::from_toml(JOINT_EXAMPLE, "joint.toml", None, Checks::Everywhere, |_| Ok(()))?;
    /// // More pressure in the agonist: a positive angle.
    /// assert!(joint.rest([1.2e5, 1e5], 0.0)?.angle_rad > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the text is no valid joint, a muscle can't be read, or the angles leave the domain of a muscle. The
    /// error states the place and the correction.
    pub fn from_toml<T>(
        text: &str,
        origin: &str,
        folder: Option<&Path>,
        checks: Checks,
        more: impl FnOnce(&Settings<'_>) -> Result<T, FileError>,
    ) -> Result<(Self, T), FileError> {
        let document = Document::parse(KIND, text, origin)?;
        let settings = document.settings("the joint", TOP);
        settings.check_keys()?;
        let linkage = linkage(&settings)?;
        let muscles = muscles(&settings, &linkage, folder)?;
        let more = more(&settings)?;
        let joint = Self {
            name: settings.text("name")?.unwrap_or("joint").to_owned(),
            linkage,
            muscles,
            angle: range::<Angle>(&settings, "angle")?,
            pressure: range::<Pressure>(&settings, "pressure")?,
        };
        check(&settings, &joint)?;
        if checks == Checks::Everywhere {
            joint.muscles.iter().try_for_each(|muscle| check_muscle(&settings, &joint, muscle))?;
        }
        Ok((joint, more))
    }
}

fn muscles(
    settings: &Settings<'_>,
    linkage: &Linkage,
    folder: Option<&Path>,
) -> Result<[JointMuscle; 2], FileError> {
    let [agonist, antagonist] = each(settings, "muscle", ["agonist", "antagonist"])?;
    let contractions = each(settings, "contraction", ["agonist_contraction", "antagonist_contraction"])?;
    let one = |side: Side, key: &'static str, contraction: &'static str| {
        let muscle = settings.muscle(key, folder)?;
        let value = settings.quantity(contraction, Dimension::NONE)?;
        let value = value.ok_or_else(|| settings.missing(contraction))?;
        if value.abs() >= 1.0 {
            let what = format!("the contraction {value} is not possible: it must be between -1 and 1");
            let instead = format!("write such as `{contraction} = \"15 %\"`");
            return Err(settings.error(settings.value_span(contraction), what, instead));
        }
        let refused = |error: &dyn std::fmt::Display| {
            let what = format!("the {}: {error}", side.name());
            settings.error(settings.value_span(key), what, "name another muscle, or correct its file")
        };
        let known = known(&muscle, &Catalogue::builtin()).map_err(|error| refused(&error))?;
        JointMuscle::new(side, linkage.clone(), muscle, known, value).map_err(|error| refused(&error))
    };
    Ok([one(Side::Agonist, agonist, contractions[0])?, one(Side::Antagonist, antagonist, contractions[1])?])
}

/// Reads the keys of the muscles: one key for both, or one for each.
fn each(
    settings: &Settings<'_>,
    both: &'static str,
    single: [&'static str; 2],
) -> Result<[&'static str; 2], FileError> {
    let strange = single.iter().find(|key| settings.get(key).is_some());
    match (settings.get(both), strange) {
        (Some(_), None) => Ok([both; 2]),
        (Some(_), Some(key)) => {
            let what = format!("`{both}` belongs to both muscles, and `{key}` to one");
            let instead = format!("delete `{key}`, or write `{}` and `{}` only", single[0], single[1]);
            Err(settings.error(settings.key_span(key), what, instead))
        }
        (None, Some(_)) => {
            let lacking = single.iter().find(|key| settings.get(key).is_none());
            lacking.map_or(Ok(single), |key| Err(settings.missing(key)))
        }
        (None, None) => Err(settings.missing(both)),
    }
}

/// Keys of a pulley, of a lever, and the additional ones of a four-bar linkage.
const PULLEY: &[&str] = &["radius"];
const LEVER: &[&str] = &["arm", "base", "lever_angle"];
const FOUR_BAR: &[&str] = &["ground", "crank", "coupler", "rocker", "rocker_angle", "crossed"];

fn linkage(settings: &Settings<'_>) -> Result<Linkage, FileError> {
    let kinds =
        [("pulley", [true, false, false]), ("lever", [false, true, false]), ("four-bar", [true, true, true])];
    let kind = settings.word("kind", &kinds)?.ok_or_else(|| settings.missing("kind"))?;
    let [is_pulley, is_lever, is_four_bar] = kind;
    for (keys, belongs) in [(PULLEY, is_pulley), (LEVER, is_lever), (FOUR_BAR, is_four_bar)] {
        let strange = keys.iter().find(|key| settings.get(key).is_some());
        if let (Some(key), false) = (strange, belongs) {
            let this = if is_lever { "lever" } else { "pulley" };
            let other = if keys == FOUR_BAR {
                "four-bar"
            } else if is_lever {
                "pulley"
            } else {
                "lever"
            };
            let what = format!("a {this} has no `{key}`");
            let instead = format!("delete `{key}`, or write `kind = \"{other}\"`");
            return Err(settings.error(settings.key_span(key), what, instead));
        }
    }
    let has = |keys: &'static [&'static str]| keys.iter().find(|key| settings.get(key).is_some()).copied();
    let drive = match (is_four_bar, has(PULLEY), has(LEVER)) {
        (true, Some(_), Some(key)) => {
            let what = format!("the crank has a pulley (`radius`) and a lever (`{key}`)");
            return Err(settings.error(settings.key_span(key), what, "delete one of the two"));
        }
        (true, Some(_), None) | (false, _, _) if is_pulley => {
            Linkage::Pulley { radius: positive::<Length>(settings, "radius")? }
        }
        _ => Linkage::Lever {
            arm: positive::<Length>(settings, "arm")?,
            base: positive::<Length>(settings, "base")?,
            lever_angle: positive::<Angle>(settings, "lever_angle")?,
        },
    };
    if !is_four_bar {
        return Ok(drive);
    }
    let bar = FourBar {
        ground: positive::<Length>(settings, "ground")?,
        crank: positive::<Length>(settings, "crank")?,
        coupler: positive::<Length>(settings, "coupler")?,
        rocker: positive::<Length>(settings, "rocker")?,
        rocker_angle: positive::<Angle>(settings, "rocker_angle")?,
        is_crossed: settings.flag("crossed")?.unwrap_or(false),
    };
    Ok(Linkage::FourBar { bar, drive: Box::new(drive) })
}

fn positive<Q: Quantity>(settings: &Settings<'_>, key: &'static str) -> Result<f64, FileError> {
    let value = settings.size::<Q>(key)?;
    let stated = settings.get(key).ok_or_else(|| settings.missing(key))?;
    if value > 0.0 {
        return Ok(value);
    }
    Err(settings.unreadable(key, stated, format!("`{key}` is {value}, but must be > 0")))
}

fn range<Q: Quantity>(settings: &Settings<'_>, key: &'static str) -> Result<[f64; 2], FileError> {
    let value = settings.get(key).ok_or_else(|| settings.missing(key))?;
    let text =
        value.text().ok_or_else(|| settings.wrong_type(key, value, "text with two values and `..`"))?;
    let ends = units::parse_range::<Q>(text).map_err(|error| settings.unreadable(key, value, error))?;
    let (low, high) = (ends.0.si(), ends.1.si());
    if low < high {
        return Ok([low, high]);
    }
    let what = format!("a range must rise, and `{text}` doesn't");
    Err(settings.unreadable(key, value, what))
}

/// Refuses ranges that leave the domain of the linkage.
fn check(settings: &Settings<'_>, joint: &Joint) -> Result<(), FileError> {
    if joint.pressure[0] <= 0.0 {
        let what =
            format!("the pressure {} is not possible: it must be > 0", Pressure::pa(joint.pressure[0]));
        let instead = "write such as `pressure = \"0.5 bar..3 bar\"`";
        return Err(settings.error(settings.value_span("pressure"), what, instead));
    }
    check_bars(settings, joint)?;
    check_lever(settings, joint)
}

/// Refuses links that don't close or whose crank stands still, for either muscle. The links of the antagonist
/// are the mirror image.
fn check_bars(settings: &Settings<'_>, joint: &Joint) -> Result<(), FileError> {
    let Linkage::FourBar { bar, .. } = joint.linkage else { return Ok(()) };
    let [low, high] = joint.angle;
    let most = high.abs().max(low.abs());
    let Some(angle) = bar.fault([-most, most]) else { return Ok(()) };
    let what = format!(
        "the four-bar linkage of one of the muscles doesn't close, or stands at a dead centre, at the angle {:.4} deg",
        // Removes the sign of a negative zero.
        angle.to_degrees() + 0.0
    );
    let instead = "write a narrower range of `angle`, or other lengths of the links";
    Err(settings.error(settings.value_span("angle"), what, instead))
}

/// Refuses a lever that passes its dead centre, beyond which it turns the other way.
fn check_lever(settings: &Settings<'_>, joint: &Joint) -> Result<(), FileError> {
    let Some([lever_angle, distance]) = joint.linkage.lever() else { return Ok(()) };
    let room = lever_angle.min(PI - lever_angle);
    if room <= 0.0 {
        let what =
            format!("`lever_angle` is {:.4} deg, but must be less than 180 deg", lever_angle.to_degrees());
        let instead = "write such as `lever_angle = \"90 deg\"`";
        return Err(settings.error(settings.value_span("lever_angle"), what, instead));
    }
    let turn = |angle: f64| match joint.linkage {
        Linkage::FourBar { bar, .. } => [angle, -angle]
            .map(|angle| bar.turn(angle).map_or(f64::INFINITY, |turn| turn.angle.abs()))
            .into_iter()
            .fold(0.0, f64::max),
        _ => angle.abs(),
    };
    if let Some(angle) = joint.angle.into_iter().find(|angle| turn(*angle) >= room) {
        let at = room.to_degrees().copysign(angle);
        let what = format!(
            "a lever is at its dead centre at the angle {at:.4} deg: beyond it the muscle would turn the joint the other way"
        );
        let instead = format!("keep `angle` between {:.4} deg and {:.4} deg", -at.abs(), at.abs());
        return Err(settings.error(settings.value_span("angle"), what, instead));
    }
    for muscle in &joint.muscles {
        let length = muscle.muscle.length().si() * (1.0 - muscle.contraction);
        if length > distance {
            let what = format!(
                "the {} is {:.4} mm long at the angle 0, but its attachments are {:.4} mm apart",
                muscle.side.name(),
                1e3 * length,
                1e3 * distance
            );
            let instead = "write a longer `base`, or a larger contraction";
            return Err(settings.error(settings.value_span("base"), what, instead));
        }
    }
    Ok(())
}

/// Refuses angles at which a muscle has no valid length.
fn check_muscle(settings: &Settings<'_>, joint: &Joint, muscle: &JointMuscle) -> Result<(), FileError> {
    let name = muscle.side.name();
    let refused =
        |what: String, instead: String| Err(settings.error(settings.value_span("angle"), what, instead));
    let contraction = |angle: f64| muscle.contraction(angle);
    let angle_at = |contraction| muscle.angle_at(contraction, joint.angle);
    // The angle at which the muscle is longest comes first.
    let mut ends = joint.angle;
    if muscle.side == Side::Antagonist {
        ends.reverse();
    }
    let [longest, shortest] = ends;
    // Direction of the angles at which the muscle is shorter, and of those at which it is longer.
    let [above, below] = if muscle.side == Side::Agonist { ["above", "below"] } else { ["below", "above"] };
    if muscle.is_singular && contraction(longest) <= 0.0 {
        let angle = angle_at(0.0).to_degrees();
        let what = format!(
            "the {name} is straight at the angle {angle:.4} deg: its fibres don't stretch, and the force is infinite there"
        );
        let instead =
            format!("keep `angle` {above} {angle:.4} deg, or write a larger contraction of the {name}");
        return refused(what, instead);
    }
    for pressure in joint.pressure {
        let limit = muscle.extended.contraction_limit(Pressure::pa(pressure), Approach::Auto);
        let limit = match limit {
            Ok(limit) => limit,
            Err(error) => {
                return refused(
                    format!("the {name} at {}: {error}", Pressure::pa(pressure)),
                    OTHER.to_owned(),
                );
            }
        };
        if contraction(shortest) > limit {
            // If the muscle is too short even at the other end, no angle helps.
            let angle = angle_at(limit).to_degrees();
            let what = format!(
                "the {name} reaches its contraction limit at {}, {:.4} %, at the angle {angle:.4} deg: beyond it the muscle doesn't pull",
                Pressure::pa(pressure),
                100.0 * limit
            );
            let instead =
                format!("keep `angle` {below} {angle:.4} deg, or write a smaller contraction of the {name}");
            return refused(what, instead);
        }
        for angle in joint.angle {
            if let Err(error) = muscle.pull(angle, pressure) {
                return refused(error.to_string(), OTHER.to_owned());
            }
        }
    }
    Ok(())
}

/// Advice if a muscle has no equilibrium.
const OTHER: &str = "write a narrower range of `angle` or `pressure`, or another contraction";
