//! `bulge fit`: effects fitted to measurements, and the muscle file that contains them.

use bulge_inference::{
    DrawnForms, Options, Posterior, PosteriorParameter, drawn_forms, fit_effects, posterior, predict,
};
use bulge_measurements::Data;
use bulge_muscles::{Muscle, units::significant};
use bulge_report::{Learnt, posterior_svg};
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::{self, Json, pretty};
use crate::compare::parameters;
use crate::data::{DataArguments, told};
use crate::diagnose::paragraph::paragraph;
use crate::failure::Failure;
use crate::files::{self, Named};
use crate::restricted::{LossArgument, RestrictedArguments};
use crate::said;
use crate::text::{table, with_interval};

/// Potential scale reduction from which draws are said to be too few.
const MIXED: f64 = 1.05;
/// An error is worth a warning if it exceeds the fitted one by this factor.
const WORSE: f64 = 1.2;

/// Fits the named effects, and writes the muscle with what was learnt: a file for `shape`, `curve` and the next `compare`.
#[derive(Debug, Args)]
pub(crate) struct FitCommand {
    #[command(flatten)]
    data: DataArguments,
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// Effects to fit: `--with end-taper,bladder-elasticity`
    #[arg(long, required = true, value_delimiter = ',', value_name = "EFFECT")]
    with: Vec<String>,
    #[command(flatten)]
    restricted: RestrictedArguments,
    #[command(flatten)]
    loss: LossArgument,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Draw the form that the data want of each effect, and write it to FILE as an effect of your own, for `--effects FILE --with EFFECT-bent` in the place of EFFECT
    #[arg(long, value_name = "FILE")]
    form_error: Option<PathBuf>,
    /// Draw how sure the numbers are: draws of the posterior, alone and in pairs, and profile likelihoods
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    posterior: Option<PathBuf>,
    /// Write the draws of the posterior, a column for each number
    #[arg(long, value_name = "FILE.csv")]
    draws: Option<PathBuf>,
    /// Seed of the draws
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// The muscle file to write [default: on standard output]
    #[arg(long, value_name = "MODEL.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl FitCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        self.check_files()?;
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let effects = arguments::effects(&catalogue, &self.with)?;
        let data = self.data.read(&muscle)?;
        let options = self.data.options(&data, &muscle, catalogue, effects)?;
        let options = self.restricted.apply(options, &data, &muscle)?;
        let options = Options { loss: self.loss.loss(), ..options };
        let (learnt, posterior) = self.learn(&data, &muscle, &options)?;
        let drawn = match &self.form_error {
            Some(path) => Some(drawn(&data, &muscle, &options, path)?),
            None => None,
        };
        if let Some(path) = &self.out {
            files::replace(path, learnt.model.as_bytes())?;
        }
        if self.json.wanted {
            let document = learnt.document().with_drawn(drawn.as_ref().map(|(drawn, _)| drawn));
            let document = document.with_posterior(posterior.as_ref().map(|(posterior, _)| posterior));
            return pretty(&document);
        }
        if self.out.is_none() {
            // Standard output holds only the file, so that it can be redirected; the numbers are in its
            // comments.
            said::message(&told(data.reading()));
            said::message(&drawn.map_or_else(String::new, |(_, says)| says));
            said::message(&posterior.map_or_else(String::new, |(_, says)| says));
            return Ok(learnt.model);
        }
        let mut text = format!("{} fitted to {}\n\n", muscle.name(), learnt.fitting.data.files.join(", "));
        text.push_str(&told(data.reading()));
        text.push_str(&lines(&learnt));
        let mut reasons: Vec<&str> = learnt.extension.left_out.iter().map(|(_, why)| *why).collect();
        reasons.sort_unstable();
        reasons.dedup();
        for why in reasons {
            let left_out = learnt.extension.left_out.iter().filter(|(_, other)| *other == why);
            let names: Vec<&str> = left_out.map(|(name, _)| name.as_str()).collect();
            paragraph(&mut text, "  ", &format!("not in the file: {} ({why})", names.join(", ")));
        }
        text.push_str(&as_written(&data, &learnt, &options));
        text.push_str(&drawn.map_or_else(String::new, |(_, says)| says));
        text.push_str(&posterior.map_or_else(String::new, |(_, says)| says));
        if let Some(path) = &self.out {
            let _ = writeln!(text, "\n  wrote {}", path.display());
        }
        Ok(text)
    }

    /// The fit, and the posterior with the text about it if one is wanted.
    fn learn(
        &self,
        data: &Data,
        muscle: &Muscle,
        options: &Options,
    ) -> Result<(Learnt, Option<(Posterior, String)>), Failure> {
        let wanted = [self.posterior.as_deref(), self.draws.as_deref()];
        // A fit with `--json` alone costs no draws.
        if wanted.iter().all(Option::is_none) {
            return Ok((learn(data, muscle, options)?, None));
        }
        let (fitting, posterior) = posterior(data, muscle, options, self.seed)?;
        if posterior.parameters.iter().all(|parameter| parameter.nuisance) {
            let option = if self.posterior.is_some() { "--posterior" } else { "--draws" };
            let what =
                "no number of an effect is fitted, so none has a posterior; fit one, or leave this out";
            return Err(Failure::Value { option, what: what.to_owned() });
        }
        let learnt = Learnt::of(fitting)?;
        let [picture, draws] = wanted;
        let title = format!("{}: what the data leave open", muscle.name());
        let mut says = surely(&posterior);
        says.push_str(&files::wrote(picture, || Ok(posterior_svg(&title, &posterior)?))?);
        says.push_str(&files::wrote(draws, || Ok(table_of_draws(&posterior)))?);
        Ok((learnt, Some((posterior, says))))
    }

    /// Rejects files that could not be written or would be overwritten: before hours of work, and before one
    /// of two is written. The fitted muscle may replace the muscle file that was read.
    fn check_files(&self) -> Result<(), Failure> {
        let read: Vec<Named<'_>> = self.data.read_with(self.effects.as_deref()).collect();
        let form_error: Vec<Named<'_>> =
            self.form_error.as_deref().map(|path| ("--form-error", path)).into_iter().collect();
        files::are_apart(&form_error, &[("the muscle file", Path::new(&self.muscle))])?;
        // Without a name and without JSON the fitted muscle goes to standard output.
        let out = self.out.as_deref().or((!self.json.wanted).then_some(Path::new("-")));
        let out = out.map(|path| ("--out", path));
        let posterior = self.posterior.as_deref().map(|path| ("--posterior", path));
        let draws = self.draws.as_deref().map(|path| ("--draws", path));
        let written: Vec<Named<'_>> =
            form_error.into_iter().chain(out).chain(posterior).chain(draws).collect();
        files::are_apart(&written, &read)?;
        written.iter().try_for_each(|(_, path)| files::can_be_written(path))
    }
}

/// A warning if the file, without what was fitted beside its effects, leaves a larger error on these data.
fn as_written(data: &Data, learnt: &Learnt, options: &Options) -> String {
    let Learnt { fitting, extension, .. } = learnt;
    if extension.left_out.is_empty() {
        return String::new();
    }
    let found = match predict(data, &extension.muscle, &options.catalogue, &options.excluded) {
        Ok(found) => found,
        // The fit stands whatever its file can do.
        Err(error) => return format!("  ! without them the file can't predict these data: {error}\n"),
    };
    let error_n = found.against.map_or(0.0, |against| against.rmse_n);
    if error_n > WORSE * fitting.rmse_n {
        format!(
            "  ! without them the file leaves an error of {} N on these data, {} N with them: `bulge predict` uses the file\n",
            significant(error_n, 3),
            significant(fitting.rmse_n, 3)
        )
    } else {
        String::new()
    }
}

/// The quantiles of the posterior as text, and a warning where the draws are too few.
fn surely(posterior: &Posterior) -> String {
    let mut text = format!("\n  posterior: {} draws\n", posterior.count);
    let heading = ["", "median", "68 %", "95 %", "r-hat"].map(str::to_owned).to_vec();
    let rows = posterior.parameters.iter().map(|p| {
        let [low, below, middle, above, high] = p.quantiles;
        let [middle, low, high] = with_interval(middle, low, high);
        let [_, below, above] = with_interval(p.quantiles[2], below, above);
        let unit = if p.unit == "1" { "" } else { &p.unit };
        vec![
            format!("{} {}", p.effect, p.name),
            format!("{middle} {unit}").trim_end().to_owned(),
            format!("{below} to {above}"),
            format!("{low} to {high}"),
            format!("{:.3}", p.r_hat),
        ]
    });
    text.push_str(&table(&std::iter::once(heading).chain(rows).collect::<Vec<_>>()));
    for p in posterior.parameters.iter().filter(|p| p.r_hat > MIXED) {
        let _ = writeln!(
            text,
            "  ! the chains of {} {} do not agree yet: its quantiles are rough",
            p.effect, p.name
        );
    }
    text
}

/// The draws as CSV.
fn table_of_draws(posterior: &Posterior) -> String {
    let name = |p: &PosteriorParameter| {
        let specimen = p.specimen.as_ref().map_or_else(String::new, |name| format!("[{name}]"));
        let unit = if p.unit == "1" { String::new() } else { format!(" [{}]", p.unit) };
        format!("{}.{}{specimen}{unit}", p.effect, p.name)
    };
    let mut text = posterior.parameters.iter().map(name).collect::<Vec<_>>().join(",") + "\n";
    for draw in &posterior.draws {
        text.push_str(&draw.iter().map(|value| format!("{value}")).collect::<Vec<_>>().join(","));
        text.push('\n');
    }
    text
}

/// Draws the form errors that the data suggest, and writes those that an expression can approximate. Returns
/// them, and the text about them.
fn drawn(
    data: &Data,
    muscle: &Muscle,
    options: &Options,
    path: &Path,
) -> Result<(DrawnForms, String), Failure> {
    let drawn = drawn_forms(data, muscle, options)?;
    let mut text = format!(
        "\n  RMS error with the formulas {:.3} N, with the forms that the data want {:.3} N\n",
        drawn.rmse_n, drawn.bent_rmse_n
    );
    for form in &drawn.forms {
        let _ = writeln!(text, "  {}", form.says);
    }
    let written: Vec<&str> =
        drawn.forms.iter().map(|form| form.toml.as_str()).filter(|toml| !toml.is_empty()).collect();
    if written.is_empty() {
        let _ = writeln!(text, "  {} is not written: there is no form to write", path.display());
    } else {
        files::write(path, written.join("\n").as_bytes())?;
        let _ = writeln!(text, "  wrote {}", path.display());
    }
    Ok((drawn, text))
}

/// Fits effects to data.
pub(crate) fn learn(data: &Data, muscle: &Muscle, options: &Options) -> Result<Learnt, Failure> {
    Ok(Learnt::of(fit_effects(data, muscle, options)?)?)
}

/// The result of a fit as text: the error before and after, the parameters, and warnings.
pub(crate) fn lines(learnt: &Learnt) -> String {
    let mut text = String::new();
    for line in learnt.errors() {
        // Writing to a String can't fail.
        let _ = writeln!(text, "  {line}");
    }
    let fit = &learnt.fitting.fit;
    parameters(&mut text, fit, &learnt.fitting.held);
    for warning in &fit.warnings {
        let _ = writeln!(text, "  ! {warning}");
    }
    text
}
