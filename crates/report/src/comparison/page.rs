//! The page: fills texts, tables and plots into the template.

use bulge_inference::{Comparison, LeftOut, Rows};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, HtmlEscape};
use serde::Serialize;

use crate::comparison::{
    Plot, breakdown, contributions, convergence, correlations, data, force, headline, isotonic, ladder,
    ladder_table, loops, parameters, parameters_table, residual_map, rivals, scatter, wording,
};
use crate::explore::{Explore, policy, replaces};
use crate::{PlotError, scripts};

const TEMPLATE: &str = include_str!("report.html");
/// Parts of every page: its style, and macros for plots and tables.
const PIECES: [(&str, &str); 3] = [
    ("plots.css", scripts::STYLE),
    ("style.css", include_str!("style.css")),
    ("pieces.html", include_str!("pieces.html")),
];

/// A plot with the sentence above it.
#[derive(Debug, Serialize)]
pub(crate) struct Figure {
    says: String,
    name: &'static str,
    title: String,
    caption: String,
    /// Whether the interactive plots of rows replace it if scripts run and the page has such plots.
    replaced: bool,
    /// Markup that the template must not escape.
    svg: Value,
}

impl Figure {
    /// From a plot and the sentence about it.
    pub(crate) fn new(plot: Plot, says: String) -> Self {
        let Plot { name, title, caption, svg } = plot;
        Self { says, name, title, caption, replaced: replaces(name), svg: Value::from_safe_string(svg) }
    }
}

/// All values of the template.
#[derive(Serialize)]
struct Page<'a> {
    muscle: &'a str,
    base: &'a str,
    version: &'static str,
    schema: &'static str,
    policy: Value,
    explore: Option<Explore>,
    headline: String,
    verdict: Vec<String>,
    key_figures: Vec<headline::Figure>,
    data_says: String,
    facts: Vec<(&'static str, String)>,
    left_out: &'a [LeftOut],
    columns: Vec<[String; 5]>,
    notes: &'a [String],
    set_apart: Vec<[String; 2]>,
    findings: Vec<data::Row>,
    ladder: Option<Figure>,
    ladder_says: String,
    rungs: Vec<ladder_table::Row>,
    force: Option<Figure>,
    errors: Vec<Figure>,
    errors_says: String,
    maps: Option<Figure>,
    loops: Option<Figure>,
    isotonic: Option<Figure>,
    contributions: Option<Figure>,
    contributions_says: String,
    scatter: Option<Figure>,
    parameters: Option<Figure>,
    parameters_says: String,
    numbers: Vec<parameters_table::Row>,
    fit_warnings: Vec<String>,
    pairs: Vec<correlations::Pair>,
    pairs_says: String,
    rivals: Vec<rivals::Row>,
    rivals_says: String,
    convergence_says: String,
    convergence: Vec<(&'static str, String)>,
    warnings: &'a [String],
    files: &'a [String],
    sha256: &'a str,
}

/// The page as HTML.
///
/// # Errors
/// A plot can't be drawn, or the template can't be filled in.
pub(super) fn render(comparison: &Comparison, rows: Option<&Rows>) -> Result<String, PlotError> {
    filled("report.html", TEMPLATE, &page(comparison, rows)?)
}

/// A template filled in with its values. It may use the common parts of every page, and the filter `code`.
///
/// # Errors
/// The template can't be filled in.
pub(crate) fn filled(name: &str, template: &str, values: &impl Serialize) -> Result<String, PlotError> {
    let failed = |error: minijinja::Error| PlotError::Page { reason: format!("{error:#}") };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    environment.set_syntax(syntax.map_err(failed)?);
    environment.add_filter("code", code);
    for (name, piece) in PIECES {
        environment.add_template(name, piece).map_err(failed)?;
    }
    environment.add_template(name, template).map_err(failed)?;
    let template = environment.get_template(name).map_err(failed)?;
    let html = template.render(Value::from(Serde(values))).map_err(failed)?;
    // Control characters are allowed neither in HTML nor in XML.
    Ok(html.replace(|c: char| (c.is_control() && c != '\n') || matches!(c, '\u{FFFE}' | '\u{FFFF}'), " "))
}

/// The plots that show model and measurement themselves, for the page of a diagnosis: curves, errors over
/// pressure and contraction, loops, contributions, fitted parameters.
///
/// # Errors
/// A plot can't be drawn.
pub(crate) fn model_and_measurement(comparison: &Comparison) -> Result<Vec<Figure>, PlotError> {
    let figures = [
        (force::plot(comparison)?, force::says(comparison)),
        (residual_map::plot(comparison)?, residual_map::says(comparison)),
        (loops::plot(comparison)?, loops::says(comparison)),
        (isotonic::plot(comparison)?, isotonic::says(comparison)),
        (contributions::plot(comparison)?, contributions::says(comparison)),
        (parameters::plot(comparison), parameters::says(comparison)),
    ];
    Ok(figures.into_iter().filter_map(|(plot, says)| Some(Figure::new(plot?, says))).collect())
}

/// A text as markup in which `commands` between backticks become code.
fn code(text: &str) -> Value {
    let pieces: Vec<String> = text.split('`').map(|piece| HtmlEscape(piece).to_string()).collect();
    // If the number of backticks is odd they are ordinary characters.
    if pieces.len().is_multiple_of(2) {
        return Value::from_safe_string(pieces.join("`"));
    }
    let marked = pieces.into_iter().enumerate().map(|(i, piece)| match i % 2 {
        0 => piece,
        _ => ["<code>", &piece, "</code>"].concat(),
    });
    Value::from_safe_string(marked.collect())
}

fn page<'a>(comparison: &'a Comparison, rows: Option<&Rows>) -> Result<Page<'a>, PlotError> {
    let explore = Explore::of(comparison, rows)?;
    let figure = |plot: Option<Plot>, says: String| plot.map(|plot| Figure::new(plot, says));
    let errors = breakdown::with_sentences(comparison)?;
    let (pairs, all_pairs) = correlations::pairs(comparison);
    let fit = wording::last_fit(comparison);
    // Warnings of the fit are often among the warnings of the comparison too.
    let fit_warnings = fit.map(|fit| fit.warnings.clone()).unwrap_or_default();
    let fit_warnings =
        fit_warnings.into_iter().filter(|warning| !comparison.warnings.contains(warning)).collect();
    Ok(Page {
        muscle: &comparison.muscle,
        base: &comparison.base,
        version: env!("CARGO_PKG_VERSION"),
        schema: comparison.schema,
        policy: Value::from_safe_string(policy(explore.is_some())),
        explore,
        headline: headline::says(comparison),
        verdict: headline::verdict(comparison),
        key_figures: headline::figures(comparison),
        data_says: data::says(comparison),
        facts: data::facts(comparison),
        left_out: &comparison.data.left_out,
        columns: data::columns(comparison),
        notes: &comparison.data.reading.notes,
        set_apart: data::set_apart(comparison),
        findings: data::findings(comparison),
        ladder: figure(ladder::plot(comparison)?, String::new()),
        ladder_says: ladder::says(comparison),
        rungs: ladder_table::rows(comparison),
        force: figure(force::plot(comparison)?, force::says(comparison)),
        errors: errors.into_iter().map(|(plot, says)| Figure::new(plot, says)).collect(),
        errors_says: headline::mean_says(comparison),
        maps: figure(residual_map::plot(comparison)?, residual_map::says(comparison)),
        loops: figure(loops::plot(comparison)?, loops::says(comparison)),
        isotonic: figure(isotonic::plot(comparison)?, isotonic::says(comparison)),
        contributions: figure(contributions::plot(comparison)?, String::new()),
        contributions_says: contributions::says(comparison),
        scatter: figure(scatter::plot(comparison)?, scatter::says(comparison)),
        parameters: figure(parameters::plot(comparison), String::new()),
        parameters_says: parameters::says(comparison),
        numbers: parameters_table::rows(comparison),
        fit_warnings,
        pairs_says: correlations::says(&pairs, all_pairs),
        pairs,
        rivals: rivals::rows(comparison),
        rivals_says: rivals::says(comparison),
        convergence_says: convergence::says(comparison),
        convergence: convergence::facts(comparison),
        warnings: &comparison.warnings,
        files: &comparison.data.files,
        sha256: &comparison.data.sha256,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_between_backticks_are_marked_and_markup_stays_text() {
        let shown =
            ["a `b` <c>", "`<a>` and `b`", "an odd ` one", "", "`a"].map(|text| code(text).to_string());
        assert_eq!(
            shown,
            [
                "a <code>b</code> &lt;c&gt;",
                "<code>&lt;a&gt;</code> and <code>b</code>",
                "an odd ` one",
                "",
                "`a"
            ]
        );
    }
}
