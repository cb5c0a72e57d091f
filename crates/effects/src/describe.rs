//! Descriptions of effects: a card as a page of text, the catalogue as a list, and both as documents for
//! programs.

use bulge_muscles::Kind;
use serde::Serialize;

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature, Stage};
use crate::catalogue::Catalogue;
use crate::effect::Effect;
use crate::law::PAPERS;
use crate::mechanism::{Form, Mechanism};

/// The largest line width.
const WIDTH: usize = 100;
/// The width of the labels below the parameters.
const LABEL: usize = 10;
/// The overview leaves out a beginning of an equation that is shorter than this.
const LEAST_EQUATION: usize = 12;

/// The card of an effect as a page of text: title, physical process, equation, parameters, signature, twins,
/// the experiment that distinguishes them, and source.
///
/// ```
/// let catalogue = bulge_effects::Catalogue::builtin();
/// let page = bulge_effects::describe(catalogue.find("coulomb-friction")?.as_ref());
/// assert!(page.starts_with("coulomb-friction: Constant friction\n"));
/// assert!(page.lines().all(|line| line.chars().count() <= 100));
/// # Ok::<(), bulge_effects::CatalogueError>(())
/// ```
#[must_use]
pub fn describe(effect: &dyn Effect) -> String {
    let card = effect.card();
    let mut page = Page::default();
    page.paragraph(0, 2, &format!("{}: {}", card.name, card.title));
    page.paragraph(0, 0, &belongs(&card, effect.stage()));
    page.line("");
    page.paragraph(0, 0, card.about);
    page.line("");
    for part in parts(card.equation) {
        page.paragraph(4, 8, part);
    }
    page.line("");
    page.parameters(&effect.parameters());
    page.item("shows", &shows(&card.signature));
    let widest = card.twins.iter().map(|twin| twin.name.chars().count()).max().unwrap_or(0);
    for (i, twin) in card.twins.iter().enumerate() {
        let label = if i == 0 { "twins" } else { "" };
        let first = format!("{label:LABEL$}{:widest$}  ", twin.name);
        page.hanging(&first, LABEL + widest + 2, twin.how);
    }
    page.item("separate", card.separate);
    page.item("needs", card.needs.says());
    page.item("mechanism", card.mechanism.name());
    page.item("form", card.form.says());
    page.item("source", &format!("{} ({})", card.source, card.evidence.says()));
    let cites = |key: &str| [card.about, card.equation, card.source].iter().any(|text| has_word(text, key));
    for paper in PAPERS.iter().filter(|paper| cites(paper.key)) {
        page.item("", &format!("{}: {}", paper.key, paper.title));
    }
    page.text
}

/// All effects by group, one line each: name, title and the beginning of the equation. The members of a
/// family follow its first one.
#[must_use]
pub fn overview(catalogue: &Catalogue) -> String {
    let cards: Vec<Card<'_>> = catalogue.iter().map(|effect| effect.card()).collect();
    let is_member =
        |card: &Card<'_>| card.family != card.name && cards.iter().any(|other| other.name == card.family);
    let mut lines: Vec<(usize, &Card<'_>)> = Vec::with_capacity(cards.len());
    let mut headings = Vec::new();
    for group in Group::ALL {
        headings.push((lines.len(), group.name()));
        for first in cards.iter().filter(|card| card.group == group && !is_member(card)) {
            lines.push((2, first));
            let members = cards.iter().filter(|card| card.name != first.name && card.family == first.name);
            lines.extend(members.map(|member| (4, member)));
        }
    }
    let names = lines.iter().map(|(indent, card)| indent + card.name.chars().count()).max().unwrap_or(0);
    let titles = lines.iter().map(|(_, card)| card.title.chars().count()).max().unwrap_or(0).min(40);
    let mut page = Page::default();
    for (i, (indent, card)) in lines.iter().enumerate() {
        for (_, heading) in headings.iter().filter(|(at, _)| *at == i) {
            page.line("");
            page.line(heading);
        }
        let named = format!("{:indent$}{}", "", card.name);
        let before = format!("{named:names$}  {:titles$}  ", card.title);
        let room = WIDTH.saturating_sub(before.chars().count());
        let equation = shortened(parts(card.equation).next().unwrap_or_default(), room);
        page.line(format!("{before}{equation}").trim_end());
    }
    page.text.trim_start_matches('\n').to_owned()
}

/// A card for programs. It owns its texts, and its numbers are in the units in which they are shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CardDocument {
    /// Name in commands, files and reports.
    pub name: String,
    /// The family under which it counts.
    pub family: String,
    /// The physical mechanism, above the family.
    pub mechanism: Mechanism,
    /// How exact the formula can be.
    pub form: Form,
    /// A heading.
    pub title: String,
    /// The physical process.
    pub about: String,
    /// The equation in plain text.
    pub equation: String,
    /// Its parameters.
    pub parameters: Vec<ParameterDocument>,
    /// The group.
    pub group: Group,
    /// The stage at which it acts.
    pub stage: Stage,
    /// The kind of muscle that has the effect; none if both have it.
    pub kind: Option<Kind>,
    /// The signature in a residual.
    pub signature: SignatureDocument,
    /// The effects with which it is confused.
    pub twins: Vec<TwinDocument>,
    /// The experiment that distinguishes it from its twins.
    pub separate: String,
    /// The data that are needed.
    pub needs: Needs,
    /// The source of the equation.
    pub source: String,
    /// The reliability of the source.
    pub evidence: Evidence,
}

/// The signature of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignatureDocument {
    /// Power of the pressure, in words.
    pub pressure: String,
    /// Parity in the direction of motion.
    pub parity: Parity,
    /// Dependence on the contraction in words.
    pub shape: String,
}

/// Another effect that data may not distinguish from this one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TwinDocument {
    /// Its name.
    pub name: String,
    /// How similar it is.
    pub how: String,
}

/// A parameter with its numbers in `unit`. If `multiple_of` names a number of the muscle, they are multiples
/// of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterDocument {
    /// The name in results.
    pub name: String,
    /// The key in a muscle file.
    pub key: String,
    /// Unit.
    pub unit: String,
    /// The number of the muscle of which the values are multiples.
    pub multiple_of: Option<&'static str>,
    /// Lower bound of a fit.
    pub low: f64,
    /// Upper bound of a fit.
    pub high: f64,
    /// A usual value.
    pub typical: f64,
    /// The value at which the effect does nothing.
    pub off: f64,
    /// Mean and standard deviation from the literature.
    pub prior: Option<[f64; 2]>,
    /// The plausible range.
    pub plausible: Option<[f64; 2]>,
    /// Whether the logarithm is fitted.
    pub logarithmic: bool,
    /// Name and unit of the reciprocal, if it is shown too.
    pub reciprocal: Option<[String; 2]>,
    /// A description.
    pub about: String,
}

impl CardDocument {
    /// The document of an effect.
    #[must_use]
    pub fn of(effect: &dyn Effect) -> Self {
        let card = effect.card();
        let twins =
            card.twins.iter().map(|t| TwinDocument { name: t.name.to_owned(), how: t.how.to_owned() });
        let Signature { pressure, parity, shape } = card.signature;
        Self {
            name: card.name.to_owned(),
            family: card.family.to_owned(),
            mechanism: card.mechanism,
            form: card.form,
            title: card.title.to_owned(),
            about: card.about.to_owned(),
            equation: card.equation.to_owned(),
            parameters: effect.parameters().iter().map(ParameterDocument::of).collect(),
            group: card.group,
            stage: effect.stage(),
            kind: card.kind,
            signature: SignatureDocument { pressure: pressure.to_owned(), parity, shape: shape.to_owned() },
            twins: twins.collect(),
            separate: card.separate.to_owned(),
            needs: card.needs,
            source: card.source.to_owned(),
            evidence: card.evidence,
        }
    }
}

impl ParameterDocument {
    fn of(card: &ParameterCard<'_>) -> Self {
        let factor = if card.relative_to.is_some() { 1.0 } else { card.factor };
        // Numbers as a person writes them: 0.3 MPa, not 0.30000000000000004.
        let shown = |si: f64| format!("{:.11e}", si / factor).parse().unwrap_or(si / factor);
        let pair = |(a, b): (f64, f64)| [shown(a), shown(b)];
        Self {
            name: card.name.to_owned(),
            key: card.key.to_owned(),
            unit: card.unit.to_owned(),
            multiple_of: card.relative_to.map(bulge_muscles::Parameter::name),
            low: shown(card.low),
            high: shown(card.high),
            typical: shown(card.typical),
            off: shown(card.off),
            prior: card.prior.map(pair),
            plausible: card.plausible.map(pair),
            logarithmic: card.logarithmic,
            reciprocal: card.reciprocal.map(|(name, unit, _)| [name.to_owned(), unit.to_owned()]),
            about: card.about.to_owned(),
        }
    }

    /// The range and the other numbers in one sentence.
    fn range(&self) -> String {
        let times =
            self.multiple_of.map_or(String::new(), |of| format!(" times the {}", of.replace('_', " ")));
        let is_off = self.typical.to_bits() == self.off.to_bits();
        let usual = if is_off { String::new() } else { format!(", usually {}", digits(self.typical)) };
        let mut parts = vec![format!("{} to {}{times}{usual}", digits(self.low), digits(self.high))];
        // The numbers of a user's formula may have no value at which it does nothing.
        if self.off == 0.0 || self.off.to_bits() != self.low.to_bits() {
            parts.push(format!("off at {}", digits(self.off)));
        }
        parts.extend(self.prior.map(|[mean, sd]| format!("prior {} +- {}", digits(mean), digits(sd))));
        let outside =
            |[low, high]: [f64; 2]| format!("implausible outside {} to {}", digits(low), digits(high));
        parts.extend(self.plausible.map(outside));
        parts.extend(self.reciprocal.as_ref().map(|[name, unit]| format!("also shown as {name} in {unit}")));
        parts.extend((self.key != self.name).then(|| format!("`{}` in a muscle file", self.key)));
        parts.extend(self.logarithmic.then(|| "fitted over its logarithm".to_owned()));
        parts.join("; ")
    }
}

/// Group, family, muscles and stage of an effect.
fn belongs(card: &Card<'_>, stage: Stage) -> String {
    let muscles = card.kind.map_or("pleated and braided", Kind::name);
    let family =
        if card.family == card.name { String::new() } else { format!(", counts under {}", card.family) };
    let acts = match stage {
        Stage::Shape => "changes the muscle whose equilibrium is solved",
        Stage::Input => "changes what reaches the muscle",
        Stage::Load => "adds a force to that of the equilibrium",
        Stage::Output => "changes what the load cell reads",
    };
    format!("{}{family}; {muscles} muscles; {acts}", card.group.name())
}

/// The signature in words.
fn shows(signature: &Signature<'_>) -> String {
    let pressure = match signature.pressure {
        "0" => "independent of the pressure".to_owned(),
        "1" => "proportional to the pressure".to_owned(),
        "2" => "with the square of the pressure".to_owned(),
        "any" => "with any power of the pressure".to_owned(),
        other => format!("with powers {other} of the pressure"),
    };
    let parity = match signature.parity {
        Parity::Even => "the same in both directions",
        Parity::Odd => "changes sign with the direction",
        Parity::Mixed => "different in the two directions",
    };
    format!("{pressure}, {parity}; over the contraction: {}", signature.shape)
}

/// The parts of an equation, which are separated by two or more blanks or by a new line.
fn parts(equation: &str) -> impl Iterator<Item = &str> {
    equation.split("  ").flat_map(str::lines).map(str::trim).filter(|part| !part.is_empty())
}

/// The beginning of an equation that fits, cut at a blank outside parentheses.
fn shortened(text: &str, room: usize) -> String {
    let text = text.trim_end_matches([',', ';']);
    if text.chars().count() <= room {
        return text.to_owned();
    }
    if room < LEAST_EQUATION {
        return String::new();
    }
    let (mut depth, mut end) = (0_i32, 0);
    for (at, c) in text.char_indices().take(room - 3) {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ' ' if depth == 0 => end = at,
            _ => (),
        }
    }
    if end == 0 { String::new() } else { format!("{} ...", text[..end].trim_end_matches([' ', ',', ';'])) }
}

/// Whether a text contains a word, such as "S1".
fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_ascii_alphanumeric()).any(|other| other == word)
}

/// A number with at most six significant digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}

/// Text in lines of at most [`WIDTH`] characters.
#[derive(Debug, Default)]
struct Page {
    text: String,
}

impl Page {
    fn line(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }

    /// Writes running text. The first line is indented by `first`, the others by `rest`.
    fn paragraph(&mut self, first: usize, rest: usize, text: &str) {
        self.hanging(&" ".repeat(first), rest, text);
    }

    /// Writes running text after `before` on the first line.
    fn hanging(&mut self, before: &str, rest: usize, text: &str) {
        let mut line = before.to_owned();
        let mut is_empty = true;
        let mut words = text.split_whitespace().peekable();
        while let Some(word) = words.next() {
            // A differential such as dF/d eps is kept in one piece.
            let is_split = word == "d" || word.ends_with("/d") || word.ends_with("(d");
            let rest_of_it = words.peek().filter(|_| is_split).map_or(0, |next| 1 + next.chars().count());
            if !is_empty && line.chars().count() + 1 + word.chars().count() + rest_of_it > WIDTH {
                self.line(line.trim_end());
                line = " ".repeat(rest);
                is_empty = true;
            }
            if !is_empty {
                line.push(' ');
            }
            line += word;
            is_empty = false;
        }
        self.line(line.trim_end());
    }

    fn item(&mut self, label: &str, text: &str) {
        self.hanging(&format!("{label:LABEL$}"), LABEL, text);
    }

    fn parameters(&mut self, cards: &[ParameterCard<'_>]) {
        if cards.is_empty() {
            self.paragraph(2, 2, "no parameter: it is there or not");
        }
        let name = cards.iter().map(|card| card.name.chars().count()).max().unwrap_or(0);
        let unit = cards.iter().map(|card| card.unit.chars().count() + 2).max().unwrap_or(0);
        for card in cards {
            let first = format!("  {:name$}  {:unit$}  ", card.name, format!("[{}]", card.unit));
            self.hanging(&first, name + unit + 6, card.about);
            self.paragraph(name + unit + 6, name + unit + 8, &ParameterDocument::of(card).range());
        }
        self.line("");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Catalogue;

    #[test]
    fn a_page_says_what_an_effect_belongs_to() {
        let page = |name: &str| describe(Catalogue::builtin().find(name).unwrap().as_ref());
        assert!(page("coulomb-friction").starts_with(
            "coulomb-friction: Constant friction\nload; pleated and braided muscles; adds a force to that of the \
             equilibrium\n"
        ));
        let of_braids = "geometry; braided muscles; changes the muscle whose equilibrium is solved\n";
        assert!(page("braid-angle-error").contains(of_braids));
    }

    /// Parameters stand in columns, what goes on is indented, and nothing is cut within a differential.
    #[test]
    fn a_page_is_laid_out() {
        let page = describe(Catalogue::builtin().find("frame-compliance").unwrap().as_ref());
        for part in [
            "\n  compliance  [um/N]  displacement per force at 1 kN\n                      0 to 20, usually 0.1; ",
            "\n                        also shown as stiffness in N/mm\n  power       [1]     power of the force ",
            "over the contraction: F\n          dF/d eps: vanishes",
            "\ntwins     force-nonlinearity  0.958 (braid)\n          fibre-stretch       0.93 (braid), 0.974 (PPAM)\n",
        ] {
            assert!(page.contains(part), "{part:?} in\n{page}");
        }
    }

    /// An equation is cut at a blank outside parentheses, if what fits says anything.
    #[test]
    fn an_equation_is_cut_where_it_makes_sense() {
        assert_eq!(shortened("F = a (b + c) d,", 15), "F = a (b + c) d");
        assert_eq!(shortened("F = a (b + c) + d", LEAST_EQUATION), "F = a ...");
        assert_eq!(shortened("F = a (b + c) + d", LEAST_EQUATION - 1), "");
        assert_eq!(shortened("(F - a*b*c*d*e)", LEAST_EQUATION), "");
    }
}
