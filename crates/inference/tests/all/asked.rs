//! What programs ask of the library, by name or in a sentence: laws, hidden effects, statements, limits; and the columns and progress that they are given.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use crate::support::{cylinder, diagnosing, effects, noisy, options, truth};
use bulge_effects::law::{Law, LawGeometry, LawPoint};
use bulge_effects::{Catalogue, ParameterCard};
use bulge_inference::{
    Block, Comparing, HideError, InferenceError, Loss, NextLimits, NoiseSource, Options, Path, Progress,
    Protocol, Stated, StatementError, Statements, compare, compare_with_rows, diagnose, drawn_forms,
    fit_effects, predict, simulate, simulate_with,
};
use bulge_measurements::{Columns, Data, ReadOptions, Trace, to_csv};
use bulge_model::Model;
use bulge_muscles::{Fault, Muscle, Quantity, preset};
use std::fmt::{Debug, Write as _};
use std::sync::{Arc, Mutex, atomic::AtomicUsize, atomic::Ordering};

fn named(name: &str) -> Muscle {
    cylinder(name, "")
}

/// Readings that a force law gives, without noise.
fn by_law(law: &Law, coefficients: &[f64], muscle: &Muscle) -> Data {
    let geometry = LawGeometry::from(muscle);
    let states: Vec<(f64, f64)> = (1..=4)
        .flat_map(|bar| (0..12).map(move |i| (1e5 * f64::from(bar), 0.01 + 0.016 * f64::from(i))))
        .collect();
    let force = |(p, e): &(f64, f64)| law.force(LawPoint::mean(*p, *e), &geometry, coefficients);
    let (pressures, contractions) = states.iter().copied().unzip();
    Data::from_columns(Columns::new(
        pressures,
        Trace::Contraction(contractions),
        states.iter().map(force).collect(),
    ))
    .unwrap()
}

#[track_caller]
fn refused<T: Debug, E: ToString>(answer: Result<T, E>, words: &[&str]) {
    let message = answer.unwrap_err().to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

/// The law's own readings give its printed coefficients, as base and as rival; other laws miss them.
#[test]
fn a_law_is_found_in_its_own_readings() {
    let muscle = named("DMSP-20-400N");
    let law = Law::find("sarosi-6").unwrap();
    let printed = law.table_for(muscle.name()).unwrap().values;
    let data = by_law(law, printed, &muscle);
    let base = |fitted| options(&[]).with_law("SAROSI-6", &muscle, fitted).unwrap();
    let (stated, fitted) =
        (compare(&data, &muscle, &base(false)).unwrap(), compare(&data, &muscle, &base(true)).unwrap());
    assert_eq!(stated.ladder[0].title, law.title);
    assert!(stated.ladder[0].rmse_n < 1e-9 && stated.ladder[0].fitted == 0, "{:?}", stated.ladder[0]);
    assert!(fitted.ladder[0].rmse_n < 1e-6 && fitted.ladder[0].fitted == 6, "{:?}", fitted.ladder[0]);
    let all = compare(&data, &muscle, &Options { rivals: true, ..options(&[]) }).unwrap().rivals;
    let rival = |name: &str| all.iter().find(|rival| rival.law == name);
    let own = rival("sarosi-6").unwrap();
    assert!(own.rmse_n < 1e-6 && own.rmse_percent < 1e-6 && own.printed_rmse_n.unwrap() < 1e-9, "{own:?}");
    assert!(own.fitted == 6 && own.held_out_rmse_n.unwrap() < 1e-3 && own.failed.is_none(), "{own:?}");
    // It isn't a law of cylinders, and not one of a single pressure or of pleated muscles.
    let other = rival("s2-cylinder").unwrap();
    assert!(other.rmse_n > 1.0 && other.printed_rmse_n.is_none(), "{other:?}");
    let full = data.force().iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    assert!((other.rmse_percent / (100.0 * other.rmse_n / full) - 1.0).abs() < 1e-9, "{other:?}");
    assert!(rival("s1-polynomial").is_none() && rival("s3-exponential").is_none(), "{all:?}");
    // Of five rows a law of six numbers says nothing.
    let few = Data::from_csv(
        "pressure [bar],contraction [%],force [N]\n2,1,300\n2,9,200\n3,5,380\n4,2,600\n4,9,450\n",
        "few.csv",
    );
    let all = compare(&few.unwrap(), &muscle, &Options { rivals: true, ..options(&[]) }).unwrap().rivals;
    let own = all.iter().find(|rival| rival.law == "sarosi-6").unwrap();
    assert!(
        own.failed.as_ref().unwrap().contains("can't be fitted to 5 rows") && own.rmse_n.is_nan(),
        "{own:?}"
    );
}

#[test]
fn a_law_that_does_not_suit_is_refused() {
    let (muscle, law) =
        (named("x"), |name: &str, with: &[&str]| options(with).with_law(name, &named("x"), true));
    refused(law("sarosi", &[]), &["there is no force law `sarosi`", "did you mean `sarosi-"]);
    refused(law("newton", &[]), &["there is no force law `newton`", "`bulge effects --laws` lists them"]);
    refused(law("s1-polynomial", &[]), &["is a law of pleated muscles, and this one is braided"]);
    refused(law("s2-cylinder", &["bladder-elasticity"]), &["`bladder-elasticity` changes the shape"]);
    assert!(options(&["coulomb-friction"]).with_law("s2-cylinder", &muscle, true).is_ok());
}

#[test]
fn hidden_effects_are_those_of_the_sentence() {
    let muscle = named("x");
    let protocol = noisy(Block { rows: 20, ..Block::loops(vec![2e5, 4e5], [0.01, 0.15], 20.0) }, 1.0);
    let hidden = |with: &[&str]| {
        let with: Vec<String> = with.iter().map(|one| (*one).to_owned()).collect();
        simulate_with(&muscle, &Catalogue::builtin(), &protocol, &with, 3)
    };
    let (model, theta) =
        truth(&muscle, &[("coulomb-friction", &[14.0]), ("presliding-hysteresis", &[12.0, 0.01])]);
    let csv = simulate(&model, &theta, &protocol, 3).unwrap().csv;
    for with in [
        &["coulomb-friction=14 N", "presliding-hysteresis=12 N", "1 %"][..],
        &[
            "coulomb-friction.force=14 N",
            "presliding-hysteresis.distance=1 %",
            "presliding-hysteresis.force=12 N",
        ],
        &[" coulomb-friction = 14 N ", "presliding-hysteresis", "12 N", "0.01"],
    ] {
        assert_eq!(hidden(with).unwrap().csv, csv, "{with:?}");
    }
    // What isn't stated is as usual; beside a stated number, what is typical.
    let number = |name: &str, place: usize, read: &dyn Fn(&ParameterCard<'_>) -> f64| {
        read(&effects(&[name])[0].parameters().remove(place).of(&muscle))
    };
    let usual = number("coulomb-friction", 0, &|card| card.usual());
    let typical = number("presliding-hysteresis", 1, &|card| card.typical);
    for (with, name, values) in [
        ("coulomb-friction", "coulomb-friction", &[usual][..]),
        ("presliding-hysteresis=12 N", "presliding-hysteresis", &[12.0, typical]),
    ] {
        let (model, theta) = truth(&muscle, &[(name, values)]);
        assert_eq!(
            hidden(&[with]).unwrap().csv,
            simulate(&model, &theta, &protocol, 3).unwrap().csv,
            "{with}"
        );
    }
    refused(hidden(&["14 N"]), &["`14 N` belongs to no effect", "`coulomb-friction=14 N`"]);
    refused(
        hidden(&["coulomb-friction=14 N", "2 N"]),
        &["`2 N` is too much for `coulomb-friction`, which has one number only"],
    );
    refused(hidden(&["presliding-hysteresis=1 N", "1 %", "2 %"]), &["which has 2 numbers only"]);
    refused(hidden(&["coulomb-friction", "coulomb-friction=3 N"]), &["stands twice"]);
    refused(hidden(&["coulomb-friction.force"]), &["has no value", "`coulomb-friction.force="]);
    refused(
        hidden(&["coulomb-friction.angle=3 deg"]),
        &["has no `angle`", "write such as `coulomb-friction.force="],
    );
    refused(hidden(&["specimen-spread=2 %"]), &["needs two specimens or more", "specimens = 3"]);
    refused(hidden(&["coulomb-frictoin"]), &["did you mean `coulomb-friction`"]);
    let fault = |with: &[&str]| hidden(with).unwrap_err().fault();
    assert_eq!([fault(&["frictoin"]), fault(&["14 N"])], [Fault::Input; 2]);
    let empty =
        simulate_with(&muscle, &Catalogue::builtin(), &Protocol::new(Vec::new()), &[], 1).unwrap_err();
    assert!(matches!(empty, HideError::Inference(_)) && empty.fault() == Fault::Input, "{empty}");
}

/// Two loops of friction, 40 rows each.
fn loops_of_friction() -> Data {
    let block = Block { rows: 40, ..Block::loops(vec![2e5, 4e5], [0.02, 0.15], 20.0) };
    let (model, theta) = truth(&named("x"), &[("coulomb-friction", &[8.0])]);
    simulate(&model, &theta, &noisy(block, 1.0), 4).unwrap().data
}

#[test]
fn statements_are_told_by_their_kind() {
    let (data, muscle) = (loops_of_friction(), named("x"));
    let stating = |hold: &[&str], bound: &[&str], tie: &[&str]| {
        let [hold, bound, tie] =
            [hold, bound, tie].map(|all| all.iter().map(|one| (*one).to_owned()).collect());
        let with = options(&["coulomb-friction", "force-offset"]);
        with.stating(&Statements { hold, bound, tie }, &data, &muscle)
    };
    let found = stating(&["coulomb-friction.force=7 N"], &["force-offset.offset=2..5 N"], &[]).unwrap();
    let fit = fit_effects(&data, &muscle, &found).unwrap();
    assert!(fit.held.len() == 1 && (fit.held[0].value - 7.0).abs() < 1e-12, "{:?}", fit.held);
    // The true offset is 0.
    let offset = fit.fit.parameters.iter().find(|one| one.effect == "force-offset").unwrap();
    assert!((offset.value - 2.0).abs() < 1e-9 && offset.at_bound == Some("lower"), "{offset:?}");
    for (wrong, kind, name) in [
        (stating(&["coulomb-friction.force"], &[], &[]), Stated::Hold, "hold"),
        (stating(&[], &["coulomb-friction.force=7 N"], &[]), Stated::Bound, "bound"),
        (stating(&[], &[], &["coulomb-friction.force=nothing"]), Stated::Tie, "tie"),
    ] {
        let error = wrong.unwrap_err();
        assert!(matches!(error, StatementError::Text { about, .. } if about == kind), "{error}");
        assert_eq!((kind.name(), error.fault()), (name, Fault::Input));
    }
    // What isn't in the fit can't be held.
    let other = stating(&["creep.force=3 N"], &[], &[]).unwrap_err();
    assert!(matches!(other, StatementError::Inference(_)) && other.fault() == Fault::Input, "{other}");
    let less = options(&[]).excluding("3-12,14", &data).unwrap();
    assert_eq!(less.excluded, [&(0..10).collect::<Vec<_>>()[..], &[11]].concat());
    refused(options(&[]).excluding("900", &data), &["900"]);
    assert_eq!(Stated::Exclude.name(), "exclude");
}

#[test]
fn errors_tell_what_failed() {
    let (data, muscle) = (loops_of_friction(), named("x"));
    let one =
        Data::from_csv("pressure [bar],contraction [%],force [N]\n2,1,300\n2,9,200\n", "two.csv").unwrap();
    let few = fit_effects(&one, &muscle, &options(&["end-factor", "force-gain"])).unwrap_err();
    assert!(
        matches!(few, InferenceError::TooFewRows { rows: 2, .. }) && few.fault() == Fault::Input,
        "{few}"
    );
    let from: InferenceError = bulge_model::ModelError::Values { given: 1, expected: 2 }.into();
    assert_eq!(from.fault(), Fault::Input);
    let base = options(&[]);
    let comparing = Comparing::new(&data, &muscle, &base).unwrap();
    let unsuitable = |name: &str| comparing.unsuitable(&effects(&[name])[0]);
    assert_eq!(unsuitable("creep"), None);
    assert!(unsuitable("temperature").unwrap().contains("temperature"));
    // A fit of nothing says so, and that of the asked is the fit alone.
    let nothing = fit_effects(&data, &muscle, &options(&[])).unwrap();
    assert_eq!(nothing.fit.convergence.reason, "there was nothing to fit");
    assert!(nothing.fit.convergence.converged && (nothing.fit.rmse_n - nothing.before_rmse_n).abs() < 1e-12);
    let asked = comparing.fitting(&effects(&["coulomb-friction"]), &[]).unwrap();
    let alone = fit_effects(&data, &muscle, &options(&["coulomb-friction"])).unwrap();
    assert!(
        (asked.fit.theta[0] - alone.fit.theta[0]).abs() < 1e-12
            && (asked.rmse_n - alone.rmse_n).abs() < 1e-12
    );
}

#[test]
fn limits_of_a_bench_are_checked() {
    let check = |pressure_pa, contraction| NextLimits { pressure_pa, contraction }.check();
    assert_eq!(check(Some([1e5, 6e5]), Some([0.0, 0.2])), Ok(()));
    assert_eq!(check(None, Some([-1.0, 0.6])), Ok(()));
    assert_eq!(check(Some([1.0, 1e8]), None), Ok(()));
    for wrong in [[0.0, 1e5], [3e5, 3e5], [1e5, 1.001e8], [f64::NAN, 1e5]] {
        let (about, what) = check(Some(wrong), None).unwrap_err();
        assert!(about == "pressure" && what.contains("write such as \"1 bar..6 bar\""), "{what}");
    }
    for wrong in [[-1.001, 0.1], [0.2, 0.2], [0.1, 0.601]] {
        let (about, what) = check(None, Some(wrong)).unwrap_err();
        assert!(about == "contraction" && what.contains("write such as \"0 %..20 %\""), "{what}");
    }
}

/// The rows of a comparison and of a prediction, written as a file, are the data again.
#[test]
fn written_columns_are_read_again() {
    let (data, muscle) = (loops_of_friction(), named("x"));
    let (comparison, rows) = compare_with_rows(&data, &muscle, &options(&["coulomb-friction"])).unwrap();
    assert!(rows.len() == data.len() && !rows.is_empty());
    let sheet = cylinder("x", "[instruments]\nforce = { noise = \"1 N\" }");
    let found = predict(&data, &sheet, &Catalogue::builtin(), &[]).unwrap();
    let headings = |csv: &str| csv.lines().next().unwrap().to_owned();
    let [compared, predicted] = [to_csv(&rows.columns()), to_csv(&found.written_columns())];
    assert!(
        headings(&compared).ends_with("force [N],base force [N],model force [N],residual [N]"),
        "{compared}"
    );
    assert!(
        headings(&predicted).ends_with("model uncertainty [N],low [N],high [N],residual [N]"),
        "{predicted}"
    );
    for csv in [compared, predicted] {
        let again = Data::from_csv(&csv, "again.csv").unwrap();
        assert_eq!((again.force(), again.pressure()), (data.force(), data.pressure()));
        assert_eq!(again.columns().time_s, data.columns().time_s);
        let column = |name: &str| -> Vec<f64> {
            let place = headings(&csv).split(',').position(|heading| heading == name).unwrap();
            csv.lines().skip(1).map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
        };
        let (model, rest) = (column("model force [N]"), column("residual [N]"));
        let read = again.contraction(0.25);
        let differs = |row: &usize| {
            (data.force()[*row] - model[*row] - rest[*row]).abs() > 1e-9
                || (read[*row] - data.contraction(0.25)[*row]).abs() > 1e-12
        };
        assert_eq!((0..data.len()).find(differs), None);
        let rms = |values: &[f64]| (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
        if csv.contains("base force") {
            let base: Vec<f64> =
                column("base force [N]").iter().zip(data.force()).map(|(base, force)| force - base).collect();
            let errors = [rms(&base), rms(&rest)];
            let ladder = [0, 1].map(|rung| comparison.ladder[rung].rmse_n);
            assert!(
                errors.iter().zip(ladder).all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
                "{errors:?} {ladder:?}"
            );
        } else {
            // Without a fit the interval is that of the load cell's noise.
            let (low, high) = (column("low [N]"), column("high [N]"));
            let half = |row: usize| [high[row] - model[row], model[row] - low[row]];
            assert!((0..data.len()).all(|row| half(row).iter().all(|half| (half - 1.959_964).abs() < 1e-5)));
            assert!(column("model uncertainty [N]").iter().all(|sd| sd.abs() < 1e-12));
        }
    }
}

#[test]
fn progress_goes_from_nothing_to_all() {
    let (told, beats) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicUsize::new(0)));
    let (say, beat) = (Arc::clone(&told), Arc::clone(&beats));
    let progress = Progress::to(move |share, what| say.lock().unwrap().push((share, what.to_owned())))
        .beating(move || {
            beat.fetch_add(1, Ordering::Relaxed);
        });
    assert_eq!(format!("{progress:?} {:?}", Progress::default()), "Progress(..) Progress(nobody)");
    let asked = bulge_inference::DiagnoseOptions { progress, ..diagnosing(&[]) };
    let found = diagnose(&loops_of_friction(), &named("x"), &asked).unwrap();
    assert_eq!(crate::support::names(&found), ["coulomb-friction"]);
    let told = told.lock().unwrap();
    assert!(
        told.len() > 3 && told.iter().all(|(share, what)| (0.0..=1.0).contains(share) && !what.is_empty())
    );
    assert!(told[0].0 < 0.2 && told[told.len() - 1].0 > 1.0 - 1e-12, "{told:?}");
    assert!(told.windows(2).all(|pair| pair[0].0 <= pair[1].0), "{told:?}");
    assert!(beats.load(Ordering::Relaxed) > 10, "{beats:?}");
}

#[test]
fn names_of_losses_and_sources() {
    for loss in Loss::ALL {
        assert_eq!(Loss::named(loss.name()), Some(loss));
    }
    assert_eq!(Loss::named("abs"), None);
    let sources = [NoiseSource::Repeats, NoiseSource::Saturated, NoiseSource::Instruments];
    assert_eq!(sources.map(NoiseSource::name), ["repeats", "saturated", "instruments"]);
}

#[test]
fn a_few_impossible_lengths_are_set_apart() {
    // In loops it would be a spike.
    let law = Law::find("s2-cylinder").unwrap();
    let mut columns = by_law(law, &[], &named("x")).columns().as_ref().clone();
    let Trace::Contraction(contractions) = &mut columns.motion else { unreachable!() };
    contractions[7] = -0.5;
    let found = compare(&Data::from_columns(columns).unwrap(), &named("x"), &options(&[])).unwrap();
    let said = found.data.left_out.iter().find(|left| left.why.contains("an impossible length")).unwrap();
    assert!(
        said.rows == 1 && said.why.contains("no muscle of 250.0 mm has a contraction of -50.0 %"),
        "{said:?}"
    );
}

/// One of three held lengths whose displacement was written with the other sign, a third of the rows.
#[test]
fn displacements_of_the_other_sign_are_set_apart() {
    let muscle = preset("ppam-2-r16").unwrap();
    let model = Model::new(&muscle);
    let csv = |turned: f64, zero: f64| {
        let mut csv = String::from("time [s],pressure [bar],displacement [mm],force [N],sweep\n");
        for row in 0..90_u32 {
            let (sweep, bar) = (row / 30, 1.0 + f64::from(row % 30) / 15.0);
            let (part, sign) = [(0.08, 1.0), (0.15, turned), (0.22, 1.0)][sweep as usize];
            let force = model.at_rest(&[], bar * 1e5, part).unwrap().force_n;
            let displacement = 1e3 * (sign * part - zero) * muscle.length().si();
            let _ = writeln!(csv, "{row},{bar},{displacement},{force},{sweep}");
        }
        let read = ReadOptions { l0_m: Some(muscle.length().si()), ..ReadOptions::default() };
        Data::from_bytes(csv.as_bytes(), "d.csv", &read).unwrap()
    };
    let found = compare(&csv(-1.0, 0.0), &muscle, &options(&[])).unwrap();
    let why = "a contraction of -15.0 %; see whether the sign of the displacement was turned there";
    let said = found.data.left_out.iter().find(|left| left.why.contains(why)).unwrap();
    assert!(said.rows == 30 && found.ladder[0].rmse_n < 1e-6, "{said:?} {}", found.ladder[0].rmse_n);
    // A wrong zero puts one length of three beyond what the muscle has, and another beside it: no sign is turned.
    let refused = compare(&csv(1.0, 0.19), &muscle, &options(&[])).unwrap_err().to_string();
    assert!(refused.contains("the contraction at line 2-31 is -11.0 %"), "{refused}");
}

#[test]
fn an_effect_whose_formula_holds_is_not_written() {
    let data = loops_of_friction();
    let says = |with: &[&str]| -> Vec<String> {
        let found = drawn_forms(&data, &named("x"), &options(with)).unwrap();
        assert!(found.forms.iter().all(|form| form.written.is_none() && form.toml.is_empty()));
        found.forms.iter().map(|form| form.says.clone()).collect()
    };
    let found = says(&["coulomb-friction", "force-offset"]);
    assert!(found[0].contains("its formula holds: the data want no other form"), "{found:?}");
    assert!(found[1].contains("its formula is exact, only its numbers can be wrong"), "{found:?}");
    let few =
        Data::from_csv("pressure [bar],contraction [%],force [N]\n2,1,300\n2,9,200\n3,5,380\n", "few.csv")
            .unwrap();
    let few = drawn_forms(&few, &named("x"), &options(&["force-offset"]));
    assert!(matches!(few, Err(InferenceError::TooFewRows { .. })), "{few:?}");
}

/// Fits of records that are so long that they begin with some of the rows (20 000 with one minimum), or take only some
/// (60 000): friction and an offset by linear least squares, and the noise as held-out error.
#[test]
fn long_records_give_what_is_hidden_in_them() {
    let muscle = named("x");
    for (rows, cycles) in [(1500, 4), (2200, 8)] {
        let block = Block {
            rows,
            cycles,
            path: Path::Triangle,
            ..Block::loops(vec![2e5, 3e5, 4e5, 5e5], [0.02, 0.18], 40.0)
        };
        let (model, theta) = truth(&muscle, &[("coulomb-friction", &[9.0]), ("force-offset", &[4.0])]);
        let data = simulate(&model, &theta, &noisy(block, 2.0), 1).unwrap().data;
        // Some rows are left out, and absurd.
        let mut columns = data.columns().as_ref().clone();
        let excluded: Vec<usize> = (0..data.len()).step_by(97).collect();
        for row in &excluded {
            columns.force_n[*row] += 300.0;
        }
        let data = Data::from_columns(columns).unwrap();
        let with = Options { excluded, ..options(&["coulomb-friction", "force-offset"]) };
        let found = compare(&data, &muscle, &with).unwrap();
        let last = found.ladder.last().unwrap();
        assert!(data.len() > if cycles == 4 { 20_000 } else { 60_000 });
        // The normal equations of friction d and offset o over the rows that count.
        let (plain, _) = truth(&muscle, &[]);
        let (contraction, history) = (data.contraction(0.25), data.history(0.25));
        let counts = |row: &usize| !row.is_multiple_of(97);
        let mut sums = [0.0; 5];
        for row in (0..data.len()).filter(counts) {
            let of_row = plain.at_rest(&[], data.pressure()[row], contraction[row]).unwrap().force_n;
            let (rest, sign) = (data.force()[row] - of_row, -history.direction[row]);
            sums =
                [sums[0] + sign * sign, sums[1] + sign, sums[2] + 1.0, sums[3] + sign * rest, sums[4] + rest];
        }
        let [ss, s, n, sr, r] = sums;
        let det = ss * n - s * s;
        let solved = [(sr * n - s * r) / det, (ss * r - s * sr) / det];
        let fit = last.fit.as_ref().unwrap();
        // At turns friction has no direction. Of the longer record 40 000 rows are taken: three standard deviations of their mean.
        let close = if cycles == 4 { 1e-3 } else { 3.0 * 2.0 / 200.0 };
        assert!(
            fit.theta.iter().zip(solved).all(|(a, b)| (a - b).abs() < close),
            "{:?} {solved:?}",
            fit.theta
        );
        assert!(
            (last.rmse_n - 2.0).abs() < 0.025 && (fit.rmse_n - 2.0).abs() < 0.025,
            "{rows}: {}",
            last.rmse_n
        );
        assert!((last.held_out_rmse_n.unwrap() - 2.0).abs() < 0.025, "{rows}: {:?}", last.held_out_rmse_n);
    }
}
