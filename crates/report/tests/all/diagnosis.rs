//! The report of a diagnosis through the public API: every verdict, around rich, bare, crowded and hostile comparisons.

use crate::diagnosed::{adequate, cannot_tell, missing, unknown};
use crate::page::{check_page, check_plots, parsed, words};
use crate::sample::{Recipe, bare, crowded, empty, hostile, rich};
use bulge_inference::{Comparison, Diagnosis, Level, Mismatch, OtherAnswer, Verdict};
use bulge_report::PlotError;
use bulge_report::diagnosis::{base_name, headlines, html, noise_says, plots, remains_says};
use roxmltree::Document;

/// The comparison of a diagnosis with two effects.
fn comparison() -> Comparison {
    let mut comparison = rich(&Recipe::usual());
    comparison.ladder.truncate(3);
    for (rung, name) in comparison.ladder[1..].iter_mut().zip(["bladder-elasticity", "coulomb-friction"]) {
        rung.added = Some(name.to_owned());
    }
    comparison
}

fn samples() -> Vec<(&'static str, Diagnosis)> {
    vec![
        ("missing", missing(comparison())),
        ("adequate", adequate(comparison())),
        ("unknown", unknown(comparison())),
        ("cannot tell", cannot_tell(comparison())),
        ("bare", adequate(bare())),
        (
            "empty",
            cannot_tell({
                let mut comparison = empty();
                comparison.ladder = bare().ladder;
                comparison
            }),
        ),
        ("crowded", missing(crowded())),
        ("hostile", missing(hostile())),
    ]
}

const SECTIONS: [&str; 11] = [
    "ladder",
    "explained",
    "candidates",
    "rivals",
    "where",
    "remaining",
    "noise",
    "limits",
    "next",
    "warnings",
    "reading",
];

#[test]
fn every_page_has_all_sections_and_keeps_to_the_rules() {
    for (sample, diagnosis) in samples() {
        let html = html(&diagnosis).unwrap();
        check_page(sample, &html);
        check_plots(sample, &plots(&diagnosis).unwrap());
        let document = parsed(&html);
        let sections: Vec<&str> = document
            .descendants()
            .filter(|n| n.has_tag_name("section"))
            .filter_map(|n| n.attribute("id"))
            .filter(|id| *id != "comparison")
            .collect();
        let is_bent = diagnosis.added().any(|m| m.form_error.as_ref().is_some_and(|e| !e.curves.is_empty()));
        let expected: Vec<&str> = SECTIONS
            .into_iter()
            .flat_map(|id| [Some(id), (id == "explained" && is_bent).then_some("bent")])
            .flatten()
            .collect();
        assert_eq!(sections, expected, "{sample}");
    }
}

#[test]
fn plots_are_those_for_which_there_are_numbers() {
    let names = |diagnosis: &Diagnosis| plots(diagnosis).unwrap().iter().map(|p| p.name).collect::<Vec<_>>();
    let own =
        ["ladder", "explained-1", "explained-2", "bent-1", "candidates", "rivals", "where", "remaining"];
    let all = names(&missing(comparison()));
    assert_eq!(all[..8], own);
    assert!(
        ["force", "residual-map", "loops", "contributions", "parameters"]
            .iter()
            .all(|name| all.contains(name))
    );
    let mut sorted = all.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), all.len(), "each is a file of its own");
    let few = names(&cannot_tell(comparison()));
    assert_eq!(few[..2], ["ladder", "candidates"]);
    assert!(own[1..4].iter().chain(&own[5..]).all(|name| !few.contains(name)), "{few:?}");
}

#[test]
fn a_jump_stands_in_the_head_in_the_place_of_advice_to_go_on() {
    let mut diagnosis = missing(comparison());
    diagnosis.remaining.structured = true;
    diagnosis.remaining.jump = Some("a jump of 9.9 N within a sweep".to_owned());
    let lines = headlines(&diagnosis);
    assert!(
        lines.iter().any(|line| line.starts_with("remains: a jump of 9.9 N within a sweep: see")),
        "{lines:?}"
    );
    assert!(lines.iter().all(|line| !line.contains("accept them")), "{lines:?}");
}

#[test]
fn verdicts_stand_in_the_first_lines() {
    let mut knocked = cannot_tell(comparison());
    knocked.remaining.event = Some("a jump of 9.9 N within a sweep".to_owned());
    let mut asked = cannot_tell(comparison());
    asked.data.findings = vec![Mismatch {
        kind: "pressure-unit",
        decided: true,
        rmse_n: 400.0,
        meant_rmse_n: Some(6.0),
        says: "is this psi read as kPa?".to_owned(),
        instead: "correct the unit".to_owned(),
    }];
    for (diagnosis, begins) in [
        (
            missing(comparison()),
            &[
                "missing: bladder-elasticity (rubber; on data like these such a claim is right 97 % of the time)",
                "missing: coulomb-friction (dry friction; by the weight of the evidence right more than 99 % of the time, not simulated)",
            ][..],
        ),
        (adequate(comparison()), &["adequate: the model explains these data within noise and tolerance"]),
        (
            unknown(comparison()),
            &[
                "unknown: these data hold a structure that no effect of the catalogue explains",
                "nearest: bladder-elasticity (it lowers the error and leaves the structure)",
            ],
        ),
        (cannot_tell(comparison()), &["cannot tell: these data allow no verdict"]),
        (asked, &["cannot tell: these readings are asked about before anything is looked for in them"]),
        (knocked, &["cannot tell: something happened during the test, and no effect is named across it"]),
    ] {
        assert_eq!(headlines(&diagnosis), begins);
        let page = words(&html(&diagnosis).unwrap());
        // A sentence begins with a capital letter.
        let shown = page.find(&begins[0][1..]).unwrap();
        assert!(shown < page.find("The ladder of errors").unwrap());
        assert!(page.contains(&diagnosis.says));
        assert_eq!(page.contains("None is confirmed."), diagnosis.added().next().is_none());
    }
}

#[test]
fn a_claim_goes_as_far_as_the_data_decide() {
    let mut diagnosis = missing(comparison());
    let first = |diagnosis: &Diagnosis| headlines(diagnosis)[0].clone();
    diagnosis.missing[0].level = Level::Mechanism;
    assert!(first(&diagnosis).starts_with("missing: rubber, likeliest bladder-elasticity (rubber; "));
    diagnosis.missing[0].level = Level::Class;
    let begins =
        "missing: one of bladder-elasticity, wall-thickness (bladder-elasticity: rubber; on data like";
    assert!(first(&diagnosis).starts_with(begins), "{}", first(&diagnosis));
    diagnosis.missing[0].class.truncate(1);
    assert!(first(&diagnosis).starts_with("missing: rubber, likeliest bladder-elasticity ("));
    // A claim that the usual doubt of the geometry would take back says so.
    let other = |differs| Some(OtherAnswer { verdict: Verdict::Unknown, missing: Vec::new(), differs });
    for (differs, ends) in
        [(false, "of the time)"), (true, ", if the geometry is as stated, which these data doubt)")]
    {
        diagnosis.geometry.if_doubtful = other(differs);
        assert!(first(&diagnosis).ends_with(ends), "{}", first(&diagnosis));
    }
    // A further effect of which not even the mechanism is likely is shown, but not claimed.
    let mut doubtful = diagnosis.missing.remove(1);
    (doubtful.confidence_mechanism, doubtful.plausible) = (0.2, true);
    diagnosis.nearest = vec![doubtful];
    let says = "nearest: coulomb-friction (something is there, and these data don't tell what)";
    assert_eq!(headlines(&diagnosis)[1], says);
    diagnosis.nearest[0].may_be_form_error = true;
    let says = "nearest: coulomb-friction (larger errors of the other formulas would explain as much)";
    assert_eq!(headlines(&diagnosis)[1], says);
}

#[test]
fn the_box_names_class_numbers_and_what_is_implausible() {
    let page = words(&html(&missing(comparison())).unwrap());
    for part in [
        "These data cannot tell it from: wall-thickness .",
        "Other forms of it, not told apart here: bladder-c01.",
        "Fitted as bouc-wen, with a transition much shorter than the strokes.",
        "modulus 0.310 MPa 95 % interval 0.280 to 0.330",
        "97 % of the time (400 such claims on simulated data like these: 95 % interval 95 to 98 %); the class holds the right effect 99 % of the time",
        "No other effect of the catalogue explains these data as well.",
        "implausible: a wrong cure",
        "1 warning:",
        "needs a column temperature that changes",
        "The fit of one did not converge",
        "2 are confirmed, 1 is not told apart from them.",
        "Hold at 3 bar for an hour.",
        "4.90 sigma",
    ] {
        assert!(page.contains(part), "{part:?} in {page}");
    }
}

#[test]
fn what_a_step_explains_is_a_share_of_squares() {
    let page = words(&html(&missing(comparison())).unwrap());
    // 1 - (2 - 1)^2/2^2.
    let says = "With bladder-elasticity the mean misfit (RMS over the dots) goes from 2.00 N to 1.00 N: it explains 75 % of what varied.";
    assert!(page.contains(says), "{page}");
}

#[test]
fn the_ladder_has_every_number_and_the_floor_of_the_diagnosis() {
    let diagnosis = missing(comparison());
    let html = html(&diagnosis).unwrap();
    let document = parsed(&html);
    let section = document.descendants().find(|n| n.attribute("id") == Some("ladder")).unwrap();
    let rows: Vec<Vec<String>> = section
        .descendants()
        .filter(|n| n.has_tag_name("tr"))
        .skip(1)
        .map(|row| {
            let cells = row.children().filter(roxmltree::Node::is_element);
            cells
                .map(|cell| cell.descendants().find_map(|n| n.text()).unwrap_or_default().trim().to_owned())
                .collect()
        })
        .collect();
    let full_scale = diagnosis.comparison.data.full_scale_n;
    let percent: f64 = rows[0][2].parse().unwrap();
    assert!((percent / (100.0 * 31.0 / full_scale) - 1.0).abs() < 6e-3, "{percent}");
    let shown = |row: &[String]| [row[1].clone(), row[3].clone(), row[4].clone()];
    assert_eq!(shown(&rows[0]), ["31.0", "33.0", "no"]);
    assert_eq!(shown(&rows[1]), ["12.0", "12.5", "no"]);
    assert_eq!(shown(&rows[2]), ["4.40", "4.50", "no"]);
    assert_eq!(shown(&rows[3]), ["4.20", "–", "yes"]);
    // One effect on two rungs, and one whose formula holds on one.
    let title = |row: usize| &diagnosis.comparison.ladder[row].title;
    assert_eq!(rows[1][0], format!("{}, by its formula", title(1)));
    assert_eq!((rows.len(), &rows[2][0]), (4, title(2)));
    assert_eq!(rows[3][0], format!("{}, as the data want it", title(1)));
    let says = "The error goes from 31.0 N to 4.40 N by the formulas and to 4.20 N with effects as the data want them, single readings scatter by 4.10 N: no \
                structure is left";
    assert!(words(&html).contains(says), "{}", words(&html));
}

#[test]
fn the_picture_of_the_ladder_has_a_bar_for_each_form_of_a_bent_effect() {
    let diagnosis = missing(comparison());
    let drawn = |diagnosis: &Diagnosis| {
        let plot = plots(diagnosis).unwrap().swap_remove(0);
        assert_eq!(plot.name, "ladder");
        let document = Document::parse(&plot.svg).unwrap();
        let texts = document.descendants().filter_map(|n| n.text()).map(str::to_owned).collect::<Vec<_>>();
        let bars = document.descendants().filter(|n| n.has_tag_name("rect"));
        let bars = bars.filter(|n| n.attribute("height") == Some("16.8"));
        let widths: Vec<f64> = bars.map(|n| n.attribute("width").unwrap().parse().unwrap()).collect();
        (texts, widths, plot.caption)
    };
    let (texts, widths, caption) = drawn(&diagnosis);
    let place = |word: &str| texts.iter().position(|text| text == word);
    let names =
        ["+ bladder-elasticity, by its formula", "+ bladder-elasticity, as the data want it"].map(place);
    assert!(names[0].is_some() && names[0] < names[1], "{texts:?}");
    assert_eq!(widths.len(), 4);
    let bent = widths[3] / widths[0];
    assert!((bent / (4.2 / diagnosis.comparison.ladder[0].rmse_n) - 1.0).abs() < 0.02, "{widths:?}");
    assert!(caption.ends_with("on data held out of the fit that was not tried."), "{caption}");
    // Without form errors nothing is said about them.
    let mut exact = missing(comparison());
    exact.ladder.pop();
    let (texts, widths, caption) = drawn(&exact);
    assert!(
        texts.iter().all(|text| !text.contains("formula")) && widths.len() == 3 && !caption.contains("bend")
    );
}

#[test]
fn sentences_are_exact() {
    let diagnosis = missing(comparison());
    assert_eq!(
        noise_says(&diagnosis),
        "a single reading scatters by 4.10 N, 1.00 N of it correlated over 5.00 s, from what a model that can follow everything smooth \
         leaves; 900 rows count as 180"
    );
    assert_eq!(
        remains_says(&diagnosis),
        "0.4 N of systematic misfit (RMS; 95 % interval 0.0 to 1.2 N): no structure beyond chance"
    );
    assert_eq!(base_name(&diagnosis), "equilibrium");
    // A base that already has an effect.
    let mut given = missing(comparison());
    given.comparison = rich(&Recipe::usual());
    given.comparison.ladder.truncate(4);
    given.comparison.ladder[1].added = Some("end-taper".to_owned());
    assert_eq!(base_name(&given), "equilibrium + end-taper");
}

#[test]
fn rivals_are_drawn_with_the_line_beyond_which_they_are_told_apart() {
    let plots = plots(&missing(comparison())).unwrap();
    let rivals = plots.iter().find(|plot| plot.name == "rivals").unwrap();
    let document = Document::parse(&rivals.svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|n| n.text()).collect();
    let place = |word: &str| texts.iter().position(|text| *text == word).unwrap();
    assert!(place("wall-thickness") < place("hoop-elasticity"), "the nearest first");
    place("3.29 sigma");
    place("32.0 sigma");
    // The lengths of the bars are proportional to the separations: 7.5 to 1.2.
    let widths: Vec<f64> = document
        .descendants()
        .filter(|n| n.has_tag_name("rect") && n.attribute("height") == Some("13.6"))
        .map(|n| n.attribute("width").unwrap().parse().unwrap())
        .collect();
    assert!((widths[1] / widths[0] - 7.5 / 1.2).abs() < 0.02, "{widths:?}");
}

#[test]
fn the_rows_of_a_diagnosis_are_drawn_in_its_page() {
    for comparison in [comparison(), hostile()] {
        let recipe = if comparison.data.files[0].contains('<') { Recipe::hostile() } else { Recipe::usual() };
        let mut diagnosis = missing(comparison);
        let without = html(&diagnosis).unwrap();
        diagnosis.rows = Some(crate::sample::rows(&recipe, &diagnosis.comparison));
        let page = html(&diagnosis).unwrap();
        assert!(page.contains(&bulge_report::policy(true)) && without.contains(&bulge_report::policy(false)));
        assert_eq!([&page, &without].map(|page| page.matches("<script").count()), [2, 0]);
        // The two drawings that the plots of rows replace are there for readers without scripts.
        assert_eq!(page.matches("<svg ").count(), without.matches("<svg ").count());
        assert_eq!(page.matches("<div class=\"without-script\">").count(), 2);
    }
}

#[test]
fn markup_in_names_stays_text_and_the_same_diagnosis_gives_the_same_bytes() {
    let mut diagnosis = missing(hostile());
    diagnosis.muscle = "<script>alert(1)</script>".to_owned();
    diagnosis.says = "<b>`x`".to_owned();
    let page = html(&diagnosis).unwrap();
    assert!(!page.contains("<script") && page.contains("&lt;b&gt;<code>x</code>"));
    assert_eq!(html(&diagnosis), html(&diagnosis));
    assert_eq!(plots(&diagnosis), plots(&diagnosis));
}

#[test]
fn what_can_not_be_drawn_is_refused_with_a_reason() {
    let refused = |change: fn(&mut Diagnosis)| {
        let mut diagnosis = missing(comparison());
        change(&mut diagnosis);
        let error = html(&diagnosis).unwrap_err();
        assert_eq!(plots(&diagnosis).unwrap_err().to_string(), error.to_string());
        error
    };
    let error = refused(|d| d.ladder[1].rmse_n = f64::NAN);
    assert!(error.to_string().starts_with("an error of the ladder is NaN: only finite"), "{error}");
    let error = refused(|d| d.remaining.surface[0].sd_n.truncate(1));
    assert_eq!(error.to_string(), "1 values of the misfit that remains where 3 are needed");
    let error = refused(|d| d.missing[0].rivals[0].separation = f64::INFINITY);
    assert!(matches!(error, PlotError::Value { .. }), "{error}");
    let error = refused(|d| d.explained[0].curves[0].before_n = vec![1e308, -1e308, 0.0]);
    assert!(matches!(error, PlotError::Span { .. }), "{error}");
    let error = refused(|d| d.comparison.scatter[3][1] = f64::NAN);
    assert!(matches!(error, PlotError::Value { .. }), "{error}");
}
