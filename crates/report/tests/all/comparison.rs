//! The report of a comparison through the public API: rich, bare, crowded and hostile samples.

#![expect(clippy::unwrap_used, reason = "a test that can't be set up fails")]

use crate::page::{check_page, check_plots, parsed, words};
use crate::sample::{Recipe, bare, crowded, empty, hostile, rich, rows};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bulge_inference::{Comparison, Rows};
use bulge_report::PlotError;
use bulge_report::comparison::plots;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::HashMap;

fn samples() -> [(&'static str, Comparison); 5] {
    [
        ("rich", rich(&Recipe::usual())),
        ("bare", bare()),
        ("empty", empty()),
        ("crowded", crowded()),
        ("hostile", hostile()),
    ]
}

/// The page without rows.
fn html(comparison: &Comparison) -> Result<String, PlotError> {
    bulge_report::comparison::html(comparison, None)
}

#[test]
fn rich_data_have_all_plots_and_bare_data_those_that_there_are() {
    let names =
        |comparison: &Comparison| plots(comparison).unwrap().iter().map(|p| p.name).collect::<Vec<_>>();
    let all = [
        "ladder",
        "force",
        "error-by-pressure",
        "error-by-contraction",
        "error-by-direction",
        "error-by-rate",
        "error-by-time",
        "error-by-sweep",
        "error-by-specimen",
        "residual-map",
        "loops",
        "isotonic",
        "contributions",
        "scatter",
        "parameters",
    ];
    assert_eq!(names(&rich(&Recipe::usual())), all);
    assert_eq!(names(&bare()), ["ladder", "force", "error-by-contraction", "residual-map", "scatter"]);
    assert_eq!(names(&empty()), [""; 0]);
}

#[test]
fn pages_and_plots_keep_to_the_rules() {
    for (sample, comparison) in samples() {
        check_page(sample, &html(&comparison).unwrap());
        check_plots(sample, &plots(&comparison).unwrap());
    }
}

/// Three significant digits, implemented independently here.
fn shown(value: f64) -> String {
    let size = value.abs();
    let text = match size {
        _ if size == 0.0 => "0".to_owned(),
        _ if size < 0.0999 => format!("{size:.4}"),
        _ if size < 0.9995 => format!("{size:.3}"),
        _ if size < 9.995 => format!("{size:.2}"),
        _ if size < 99.95 => format!("{size:.1}"),
        _ => format!("{size:.0}"),
    };
    if value < 0.0 { format!("−{text}") } else { text }
}

#[test]
fn every_number_of_the_ladder_is_on_the_page() {
    let mut comparison = rich(&Recipe::usual());
    comparison.ladder[1].bias_n = -12.34;
    let html = html(&comparison).unwrap();
    let document = parsed(&html);
    let section = document.descendants().find(|n| n.attribute("id") == Some("ladder")).unwrap();
    let rows: Vec<_> = section.descendants().filter(|n| n.has_tag_name("tr")).skip(1).collect();
    assert_eq!(rows.len(), comparison.ladder.len());
    for (row, rung) in rows.into_iter().zip(&comparison.ladder) {
        let cells: Vec<String> = row
            .children()
            .filter(roxmltree::Node::is_element)
            .map(|cell| cell.descendants().find_map(|n| n.text()).unwrap_or_default().trim().to_owned())
            .collect();
        assert_eq!(cells[0], rung.title);
        let numbers = [rung.rmse_n, rung.rmse_percent, rung.bias_n, rung.largest_n];
        let optional = [rung.held_out_rmse_n, rung.half_gap_rmse_n];
        let optional = optional.map(|v| v.map_or("–".to_owned(), shown));
        let bias = if rung.bias_n > 0.0 { format!("+{}", shown(rung.bias_n)) } else { shown(rung.bias_n) };
        let [rmse, percent, _, largest] = numbers.map(shown);
        assert_eq!(cells[1..7], [rmse, percent, bias, largest, optional[0].clone(), optional[1].clone()]);
        assert_eq!(cells[8], rung.fitted.to_string());
    }
}

#[test]
fn sentences_name_the_side_of_an_error() {
    let html = html(&rich(&Recipe::usual())).unwrap();
    let words = words(&html);
    assert!(words.contains("At 3 bar the base pulls"), "pressure");
    assert!(
        words.contains("too hard on average"),
        "the base has no friction and no bladder: it pulls too hard"
    );
    assert!(words.contains("the friction is there in the right size"), "loops");
    assert!(words.contains("1 outside the plausible range (a wrong cure)"), "parameters");
    for tag in ["implausible: a wrong cure", "at the upper bound", "not determined by these data", "nuisance"]
    {
        assert!(words.contains(tag), "{tag}");
    }
}

#[test]
fn a_sign_that_changes_with_the_direction_is_said() {
    let mut comparison = rich(&Recipe::usual());
    let by = comparison.by.iter_mut().find(|by| by.variable == "direction").unwrap();
    (by.bins[0].bias_n[1], by.bins[1].bias_n[1]) = (-9.0, 9.0);
    let html = html(&comparison).unwrap();
    assert!(
        html.contains(
            "The error changes sign, which points to something that depends on the direction: friction or hysteresis"
        )
    );
}

#[test]
fn sentences_follow_the_numbers() {
    let words = |change: fn(&mut Comparison)| {
        let mut comparison = rich(&Recipe::usual());
        change(&mut comparison);
        words(&html(&comparison).unwrap())
    };
    for (change, says) in [
        (
            (|c| {
                c.ladder.truncate(2);
                (c.ladder[0].rmse_n, c.ladder[1].rmse_n) = (10.0, 20.0);
            }) as fn(&mut Comparison),
            "by 10.0 N; 1 effect raises the error to 20.0 N. None of the effects lowers the error.",
        ),
        (
            |c| c.ladder[4].rmse_n = 2.51,
            "That is 1.00 times the noise floor: as good as these data can tell.",
        ),
        (|c| c.ladder[4].held_out_rmse_n = Some(3.9), "is 3.90 N, about as large: the model does as well"),
        (
            |c| c.ladder[4].held_out_rmse_n = Some(39.0),
            "is 39.0 N, much larger: the fit knows these readings",
        ),
        (
            |c| c.ladder[4].held_out_rmse_n = Some(39.0),
            "lowest with “Gain of the pressure sensor” (5.85 N): what was added after it follows these readings",
        ),
        (|c| c.noise_floor = None, "The scatter of the readings is not known"),
        (|c| c.ladder[4].bias_n = 0.0, "the model with all effects pulls as hard as the muscle."),
        (
            |c| c.ladder[4].fit.as_mut().unwrap().convergence.minima = 3,
            "and 2 other minima with larger errors were seen as well.",
        ),
        (
            |c| c.ladder[4].fit.as_mut().unwrap().convergence.converged = false,
            "The search did not end in a minimum",
        ),
        (
            |c| c.loops.iter_mut().for_each(|l| l.half_gap_model_n[1].iter_mut().for_each(|f| *f *= 0.5)),
            "part of the friction is still missing",
        ),
    ] {
        assert!(words(change).contains(says), "{says}");
    }
}

#[test]
fn a_ladder_on_which_nothing_was_fitted_has_no_search() {
    let mut comparison = rich(&Recipe::usual());
    for rung in &mut comparison.ladder {
        if let Some(fit) = &mut rung.fit {
            fit.parameters.clear();
            fit.correlations.clear();
        }
    }
    let words = words(&html(&comparison).unwrap());
    assert!(words.contains("Nothing was fitted") && !words.contains("How the search ended"));
}

#[test]
fn markup_in_names_stays_text() {
    let html = html(&hostile()).unwrap();
    assert!(!html.contains("<script") && html.contains("&lt;script&gt;"));
    let document = parsed(&html);
    let heading = document.descendants().find(|n| n.has_tag_name("h1")).unwrap();
    assert_eq!(heading.text().unwrap().trim(), "<script>alert(\"1\")</script> & 'b'");
}

/// Samples with rows, and their pages.
fn with_rows() -> Vec<(Comparison, Rows, String)> {
    let samples = [
        (Recipe::usual(), rich(&Recipe::usual())),
        (Recipe::bare(), bare()),
        (Recipe::crowded(), crowded()),
        (Recipe::hostile(), hostile()),
    ];
    let page = |(recipe, comparison): (Recipe, Comparison)| {
        let rows = rows(&recipe, &comparison);
        let page = bulge_report::comparison::html(&comparison, Some(&rows)).unwrap();
        (comparison, rows, page)
    };
    samples.map(page).into()
}

/// The texts of the elements `script`, and the page without them.
fn scripts(page: &str) -> (Vec<&str>, String) {
    let mut pieces = page.split("<script");
    let mut rest = pieces.next().unwrap().to_owned();
    let mut scripts = Vec::new();
    for piece in pieces {
        let (script, after) = piece.split_once("</script>").unwrap();
        scripts.push(script.split_once('>').unwrap().1);
        rest += after;
    }
    (scripts, rest)
}

/// Header and columns of the rows in a page.
fn rows_of(page: &str) -> (Value, HashMap<String, Vec<f32>>) {
    let bytes = STANDARD.decode(scripts(page).0[0]).unwrap();
    let length = usize::try_from(u32::from_le_bytes(bytes[..4].try_into().unwrap())).unwrap();
    let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
    let numbers = bytes[4 + length..].chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
    let numbers: Vec<f32> = numbers.collect();
    let count = usize::try_from(header["rows"].as_u64().unwrap()).unwrap();
    let names = header["columns"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap().to_owned());
    let columns: HashMap<_, _> = names.zip(numbers.chunks(count).map(<[f32]>::to_vec)).collect();
    assert_eq!(numbers.len(), count * columns.len());
    (header, columns)
}

#[test]
fn the_rows_of_a_page_are_those_of_the_comparison() {
    for (comparison, rows, page) in with_rows() {
        let (header, columns) = rows_of(&page);
        let single = |values: &[f64], scale: f64| -> Vec<f32> {
            values.iter().map(|value| (value * scale).to_string().parse().unwrap()).collect()
        };
        assert_eq!(columns["measured"], single(&rows.measured_n, 1.0));
        assert_eq!(columns["pressure"], single(&rows.pressure_pa, 1e-5));
        assert_eq!(columns["contraction"], single(&rows.contraction, 100.0));
        assert_eq!(columns["model"], single(&rows.model_n, 1.0));
        let line: Vec<f32> = rows.line.iter().map(|line| line.to_string().parse().unwrap()).collect();
        assert_eq!(columns["line"], line);
        let forces: Vec<&Vec<f64>> =
            [&rows.base_n].into_iter().chain(&rows.between_n).chain([&rows.model_n]).collect();
        let rungs = header["report"]["rungs"].as_array().unwrap();
        assert_eq!(rungs.len(), comparison.ladder.len());
        for (place, (rung, of_ladder)) in rungs.iter().zip(&comparison.ladder).enumerate() {
            assert_eq!(rung["added"].as_str(), of_ladder.added.as_deref());
            assert_eq!(columns[rung["column"].as_str().unwrap()], single(forces[place], 1.0));
            let errors = (0..rows.len()).filter(|row| rows.counts[*row]);
            let errors: Vec<f64> = errors.map(|row| rows.measured_n[row] - forces[place][row]).collect();
            let rmse = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
            assert!((rung["rmse_n"].as_f64().unwrap() - rmse).abs() < 1e-9 * rmse);
        }
        for (row, state) in columns["state"].iter().enumerate() {
            let expected = if rows.excluded[row] {
                "-1"
            } else if rows.counts[row] {
                "1"
            } else {
                "0"
            };
            assert_eq!(state.to_string(), expected);
        }
        assert_eq!(header["files"], serde_json::to_value(&rows.files).unwrap());
        assert!(header["report"]["every"] == 1 && header["report"]["all"] == rows.len());
    }
}

#[test]
fn many_rows_are_thinned_and_the_page_stays_light() {
    let recipe = Recipe { rows: 5000, ..Recipe::usual() };
    let comparison = rich(&Recipe::usual());
    let rows = rows(&recipe, &comparison);
    assert_eq!(rows.len(), 100_000);
    let page = bulge_report::comparison::html(&comparison, Some(&rows)).unwrap();
    assert!(page.len() < 3_000_000, "{}", page.len());
    let (header, columns) = rows_of(&page);
    assert!(
        header["rows"] == 10_000 && header["report"]["every"] == 10 && header["report"]["all"] == 100_000
    );
    assert_eq!(columns["line"][..3], [2.0, 12.0, 22.0]);
    // The error is computed from all rows.
    let errors =
        (0..rows.len()).filter(|row| rows.counts[*row]).map(|row| rows.measured_n[row] - rows.base_n[row]);
    let errors: Vec<f64> = errors.collect();
    let rmse = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    let shown = header["report"]["rungs"][0]["rmse_n"].as_f64().unwrap();
    assert!((shown - rmse).abs() < 1e-9 * rmse, "{shown} {rmse}");
}

#[test]
fn a_page_with_rows_runs_its_own_script_alone_and_is_else_the_page_without_them() {
    for (comparison, _, page) in with_rows() {
        let (scripts, rest) = scripts(&page);
        assert_eq!(scripts.len(), 2, "the rows, and the script");
        assert!(scripts[0].bytes().all(|b| b.is_ascii_alphanumeric() || b"+/=".contains(&b)));
        let hash = STANDARD.encode(Sha256::digest(scripts[1]));
        let policy = format!(
            "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; img-src data:"
        );
        assert!(policy == bulge_report::policy(true) && rest.contains(&policy));
        let document = parsed(&rest);
        let explore = document.descendants().find(|n| n.attribute("id") == Some("explore")).unwrap();
        assert_eq!(explore.attribute("class"), Some("with-script"));
        // Without scripts all drawings are visible.
        let drawings = |page: &str| page.matches("<svg ").count();
        assert_eq!(drawings(&rest), drawings(&html(&comparison).unwrap()));
        assert_eq!(rest.matches("<figure").count(), plots(&comparison).unwrap().len());
    }
}

#[test]
fn rows_of_different_lengths_are_refused() {
    let comparison = rich(&Recipe::usual());
    let mut uneven = rows(&Recipe::usual(), &comparison);
    uneven.rate.pop();
    let error = bulge_report::comparison::html(&comparison, Some(&uneven)).unwrap_err();
    assert_eq!(error.to_string(), "899 values of a column of rows where 900 are needed");
    let mut fewer = rows(&Recipe::usual(), &comparison);
    fewer.between_n.pop();
    let error = bulge_report::comparison::html(&comparison, Some(&fewer)).unwrap_err();
    assert_eq!(error.to_string(), "2 forces of rungs between base and model where 3 are needed");
}

#[test]
fn correlated_pairs_are_listed_once() {
    let html = html(&rich(&Recipe::usual())).unwrap();
    assert_eq!(html.matches("−0.973</td>").count(), 1);
    assert_eq!(html.matches("0.914</td>").count(), 1);
}

#[test]
fn the_same_comparison_gives_the_same_bytes() {
    let comparison = crowded();
    assert_eq!(html(&comparison), html(&comparison));
    assert_eq!(plots(&comparison), plots(&comparison));
}

#[test]
fn what_can_not_be_drawn_is_refused_with_a_reason() {
    let refused = |change: fn(&mut Comparison)| {
        let mut comparison = rich(&Recipe::usual());
        change(&mut comparison);
        let error = html(&comparison).unwrap_err();
        assert_eq!(plots(&comparison).unwrap_err().to_string(), error.to_string());
        error
    };
    let error = refused(|c| c.scatter[3][1] = f64::NAN);
    assert!(matches!(error, PlotError::Value { .. }), "{error}");
    let error = refused(|c| c.ladder[2].rmse_n = f64::INFINITY);
    assert!(error.to_string().starts_with("an error of the ladder is inf: only finite"), "{error}");
    let error = refused(|c| c.maps[0].first_n.truncate(3));
    assert_eq!(error.to_string(), "3 cells of a residual map where 60 are needed");
    let error = refused(|c| c.contributions[0].parts[0].force_n.truncate(3));
    assert!(matches!(error, PlotError::Lengths { .. }), "{error}");
    let error = refused(|c| c.scatter[0] = [1e308, -1e308, 0.0]);
    assert!(matches!(error, PlotError::Span { .. }), "{error}");
}
