//! Formulas as a whole: values, derivatives, units, messages and limits.

use super::*;
use bulge_numerics::Dual;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

const FORCE: Dimension = Dimension::FORCE;
const NONE: Dimension = Dimension::NONE;

fn pure(text: &str) -> Expression {
    Expression::parse(text, &[("a", NONE), ("b", NONE), ("c", NONE)], NONE).unwrap_or_else(|e| panic!("{e}"))
}

/// A different value for each variable.
fn state() -> [f64; VARIABLES.len()] {
    std::array::from_fn(|index| 0.3 + 0.17 * index as f64)
}

#[test]
fn values() {
    let (a, b, c) = (0.7_f64, -1.3_f64, 2.2_f64);
    for (text, expected) in [
        ("a + b*c - a/b", a + b * c - a / b),
        ("-a^2", -(a * a)),
        ("c^a^2", c.powf(a * a)),
        ("c^-2", 1.0 / (c * c)),
        ("b^3", b * b * b),
        ("c^1.7", c.powf(1.7)),
        ("c^(1/2)", c.sqrt()),
        ("c^a", c.powf(a)),
        ("sqrt(a) + exp(b) + ln(c) + log10(a)", a.sqrt() + b.exp() + c.ln() + a.log10()),
        ("sin(a) + cos(b) + tan(c) + asin(a) + atan(b)", a.sin() + b.cos() + c.tan() + a.asin() + b.atan()),
        ("tanh(a) + sinh(b) + cosh(c)", a.tanh() + b.sinh() + c.cosh()),
        ("abs(b) + sign(b) + step(b) + 10*step(a)", 1.3 - 1.0 + 10.0),
        ("min(a, b) - 2*max(a, b, c)", b - 2.0 * c),
        ("clamp(c, a, 1) + clamp(b, a, 1)", 1.0 + a),
        ("if(a < c, 2, 3) + if(a > c, 20, 30) + if(2 <= 2, 100, 0) + if(1 >= 2, 0, 1000)", 1132.0),
        ("if(b > 0, ln(b), 0)", 0.0),
        ("pi * 25 [deg] / 180 [deg]", std::f64::consts::PI * 25.0 / 180.0),
        ("20 [%] + 3 [mm] / 1 [m]", 0.203),
    ] {
        let found = pure(text).evaluate(&state(), &[a, b, c]);
        assert!(
            (found - expected).abs() <= 1e-14 * expected.abs().max(1.0),
            "{text}: {found} is not {expected}"
        );
    }
}

#[test]
fn every_variable_has_its_place_and_its_unit() {
    for (index, variable) in VARIABLES.iter().enumerate() {
        let per = [("per", FORCE.over(variable.dimension).unwrap())];
        for name in [Some(variable.name), variable.alias].into_iter().flatten() {
            let formula = Expression::parse(&format!("per * {name}"), &per, FORCE).unwrap();
            assert_eq!(formula.evaluate(&state(), &[1.0]).to_bits(), state()[index].to_bits(), "{name}");
            assert!(formula.uses_variable(index) && formula.uses_parameter(0) && !formula.uses_variable(99));
            assert!(Expression::parse(name, &[], NONE).is_ok() == variable.dimension.is_none(), "{name}");
        }
    }
    let short: f64 = pure("eps").evaluate(&[], &[]);
    assert!(short.is_nan());
}

#[test]
fn the_formula_of_the_manual() {
    let text = "-mu * p * (1 - eps) * direction + k*max(0, eps - eps_c)^2";
    let parameters = [("mu", Dimension::AREA), ("k", FORCE), ("eps_c", NONE)];
    let formula = Expression::parse(text, &parameters, FORCE).unwrap();
    let (pressure, eps) = (2e5, 0.25);
    let mut state = [Dual::<5>::from(f64::NAN); VARIABLES.len()];
    state[0] = Dual::variable(pressure, 0);
    state[1] = Dual::variable(eps, 1);
    state[6] = Dual::from(-1.0);
    let (mu, k, at) = (3e-5, 120.0, 0.1);
    let found =
        formula.evaluate(&state, &[Dual::variable(mu, 2), Dual::variable(k, 3), Dual::variable(at, 4)]);
    let slack = eps - at;
    let expected = [
        mu * (1.0 - eps),
        -mu * pressure + 2.0 * k * slack,
        pressure * (1.0 - eps),
        slack * slack,
        -2.0 * k * slack,
    ];
    assert!((found.value() - (mu * pressure * (1.0 - eps) + k * slack * slack)).abs() < 1e-12);
    for (found, expected) in found.gradient().iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-13 * expected.abs(), "{found} is not {expected}");
    }
    assert_eq!(formula.to_string(), "-mu*p*(1 - eps)*direction + k*max(0, eps - eps_c)^2");
    // Below the kink and exactly at it, nothing depends on k or eps_c.
    for below in [0.05, at] {
        state[1] = Dual::variable(below, 1);
        let found = formula.evaluate(&state, &[Dual::from(mu), Dual::variable(k, 3), Dual::variable(at, 4)]);
        assert_eq!((found.gradient()[3], found.gradient()[4]), (0.0, 0.0));
    }
}

#[test]
fn kinks_have_no_infinite_derivative() {
    let formula = pure("sqrt(max(0, a - b)) + (a - a)^1.5 + abs(a - b) + 0^2 + (a - b)^2");
    let found =
        formula.evaluate(&[], &[Dual::<2>::variable(1.0, 0), Dual::variable(1.0, 1), Dual::from(0.0)]);
    assert_eq!((found.value(), *found.gradient()), (0.0, [0.0, 0.0]));
}

#[test]
fn constants_are_computed_once() {
    assert_eq!(pure("2*(3 + 4)^2/7 + exp(0)").tape.len(), 1);
    assert_eq!(pure("a^(2*3)").tape.len(), 2);
    assert_eq!(pure("a*(2 + 3)"), pure("a * 5"));
    assert_ne!(pure("a*5"), pure("5*a"));
}

#[track_caller]
fn refuses(text: &str, place: &str, parts: &[&str]) {
    let parameters = [("k", FORCE), ("eps_c", NONE), ("area", Dimension::AREA)];
    let error = Expression::parse(text, &parameters, FORCE).map(|found| found.to_string()).unwrap_err();
    assert_eq!(&text[error.span()], place, "{error}");
    let message = error.to_string();
    for part in parts {
        assert!(message.contains(part), "{text}: {message} does not say {part:?}");
    }
}

#[test]
fn units_that_do_not_fit() {
    refuses(
        "p + eps",
        "p + eps",
        &["`p` (Pa) cannot be added to `eps` (1)", "multiply `eps` by a quantity in Pa"],
    );
    refuses("k*(eps - l0)", "eps - l0", &["`l0` (m) cannot be subtracted from `eps` (1)", "quantity in 1/m"]);
    refuses("k + 3", "k + 3", &["give the number its unit: `3 [N]`"]);
    refuses("3 - k", "3 - k", &["give the number its unit: `3 [N]`"]);
    refuses(
        "max(p, 1e5)*area",
        "p, 1e5",
        &["`p` (Pa) and `1e5` (1) cannot stand in one `max`", "`1e5 [Pa]`"],
    );
    refuses("k*if(p < eps, 1, 2)", "p < eps", &["`p` (Pa) cannot be compared with `eps` (1)"]);
    refuses("if(eps < 1, k, p)", "k, p", &["cannot stand in one `if`"]);
    refuses("clamp(k, 0, p)", "k, 0, p", &["`k` (N) and `p` (Pa) cannot stand in one `clamp`"]);
    refuses("  p ", "p", &["gives a pressure (Pa), but must give a force (N)", "quantity in m^2"]);
    refuses("eps", "eps", &["gives a pure number, but must give a force (N)"]);
    refuses("k*exp(p)", "p", &["`exp` needs a pure number, but `p` (Pa) has a unit", "`1 [Pa]`"]);
    refuses("k*2^time", "time", &["the exponent `time` (s) has a unit"]);
    refuses("p^eps*k", "p^eps", &["`p` (Pa) has a unit, so its exponent must be a constant number"]);
    refuses("p^0.3*k", "p^0.3", &["no unit with whole or half powers"]);
    refuses("sqrt(sqrt(l0))*k", "sqrt(l0)", &["no unit with halves"]);
    refuses("l0^50*l0^50", "l0^50*l0^50", &["a power beyond 64"]);
    refuses("k*eps^2000", "eps^2000", &["beyond 1000"]);
    refuses("k/(1 - 1)*(1/0)", "1/0", &["`1/0` is not a finite number"]);
    refuses("k*ln(0 - 1)", "ln(0 - 1)", &["not a finite number"]);
    for text in [
        "0",
        "-0",
        "max(0, k)",
        "k*(0*eps)",
        "sqrt(k^2)",
        "k^0.5*k^(1/2)",
        "abs(-k)",
        "p*area",
        "clamp(0, 0, 0)",
        "sqrt(p*area)*sqrt(k)",
        "sign(p)*k",
        "step(time)*k",
        "if(0 < p, 0, k)",
        "tension*radius/mid_radius",
    ] {
        assert!(Expression::parse(text, &[("k", FORCE), ("area", Dimension::AREA)], FORCE).is_ok(), "{text}");
    }
}

#[test]
fn formulas_that_are_none() {
    refuses("", "", &["the formula is empty", "-k * eps"]);
    refuses(" \n ", "", &["the formula is empty"]);
    refuses(
        "k*epss",
        "epss",
        &[
            "unknown name `epss`",
            "did you mean `eps`?",
            "parameters here: k, eps_c, area",
            "variables: p, eps, length",
        ],
    );
    refuses("k*presure", "presure", &["did you mean `pressure`?"]);
    refuses("k*P", "P", &["did you mean `p`?"]);
    refuses("k*log(eps)", "log", &["unknown function `log`", "did you mean `ln`?", "functions: sqrt, exp"]);
    refuses("k*sqtr(eps)", "sqtr", &["did you mean `sqrt`?"]);
    refuses("k*sqrt", "sqrt", &["is a function", "`sqrt(x)`"]);
    refuses("k(1 - eps)", "k(", &["`k` is a number, not a function", "`k * (`"]);
    refuses("2k", "k", &["`k` where an operator should stand", "such as `*`"]);
    refuses("3 N", "N", &["`3 [N]`"]);
    refuses("3 [Nn]", "Nn", &["unknown unit `Nn`"]);
    refuses("3 [N", "[", &["not closed"]);
    refuses("3 [N [m]", "[", &["not closed"]);
    refuses("3 [N\n]", "[", &["not closed"]);
    refuses("3 []]", "]", &["`]` is no sign"]);
    refuses("k [N]", "[N]", &["does not stand behind a number"]);
    refuses("k*", "", &["the formula ends where a number, a name or `(` should stand"]);
    refuses("(k", "", &["ends where `)` should stand"]);
    refuses("k)", ")", &["`)` where an operator should stand"]);
    refuses("k*()", ")", &["`)` where a number"]);
    refuses("*k", "*", &["`*` where a number"]);
    refuses("k ** 2", "**", &["write `^`"]);
    refuses("k*(eps < 1)", "<", &["outside of `if`"]);
    refuses("if(eps, k, 0)", ",", &["a comma where a comparison"]);
    refuses("if(eps == 1, k, 0)", "=", &["within `if`"]);
    refuses("if(0 < eps < 1, k, 0)", "<", &["compare one time"]);
    refuses("k*1,5", ",", &["decimals with a point"]);
    refuses("k*1.2.3", "1.2.", &["a decimal point without its number"]);
    refuses("k*.", ".", &["a decimal point without its number"]);
    refuses("1e400*k", "1e400", &["not finite"]);
    refuses("min(k)", "min(k)", &["`min` has 1 argument here", "`min(a, b)`"]);
    refuses("clamp(k, 0)", "clamp(k, 0)", &["2 arguments", "clamp(x, low, high)"]);
    refuses("k*exp(1, 2)", "exp(1, 2)", &["2 arguments"]);
    refuses("k*20%", "%", &["`20 [%]`"]);
    refuses("k*eps\u{b2}", "\u{b2}", &["`^2`"]);
    refuses("k*\u{3b5}", "\u{3b5}", &["write it out, such as `eps`"]);
    refuses("k*\u{416}", "\u{416}", &["letters a to z"]);
    refuses("k*\u{1f600}", "\u{1f600}", &["no sign of a formula"]);
    refuses("k*\u{0}", "\u{0}", &["no sign of a formula"]);
}

#[test]
fn places_are_lines_and_columns() {
    let error = Expression::parse("eps +\n  epss", &[], NONE).unwrap_err();
    assert_eq!((error.line(), error.column(), error.what()), (2, 3, "unknown name `epss`"));
    let expected = "formula:2:3: unknown name `epss`\n  |\n2 |   epss\n  |   ^^^^\n  = did you mean `eps`?\n";
    assert!(error.to_string().starts_with(expected), "{error}");
}

#[test]
fn names_of_parameters() {
    for (name, part) in [
        ("", "no name"),
        ("2a", "no name"),
        ("a-b", "no name"),
        ("\u{3bc}", "no name"),
        ("p", "is a variable already: gauge pressure"),
        ("pressure", "is a variable already"),
        ("sqrt", "is a function already"),
        ("if", "is a function already"),
        ("pi", "is a constant already"),
    ] {
        assert!(check_name(name, &VARIABLES).unwrap_err().contains(part), "{name}");
        assert!(Expression::parse("0", &[(name, NONE)], FORCE).is_err());
    }
    let error = Expression::parse("a", &[("a", NONE), ("a", NONE)], NONE).unwrap_err();
    assert!(error.what().contains("two parameters"));
}

#[test]
fn limits_are_messages() {
    let refused = |text: &str, part: &str| {
        let message = Expression::parse(text, &[("a", NONE)], NONE).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
        assert!(message.len() < 2000);
    };
    for (open, close) in
        [("(", ")"), ("-", ""), ("+", ""), ("sqrt(", ")"), ("2^", ""), ("max(1,", ")"), ("if(1<", ",1,1)")]
    {
        let nested = |depth: usize| format!("{}a{}", open.repeat(depth), close.repeat(depth));
        assert!(Expression::parse(&nested(60), &[("a", NONE)], NONE).is_ok(), "{open}");
        refused(&nested(65), "64");
        refused(&nested(1000), "64");
        refused(&open.repeat(2000), "64");
    }
    refused(&"(".repeat(100_000), "at most 16384");
    refused(&format!("a{}", "+a".repeat(4096)), "more than 4096 parts");
    refused(&format!("a{}", "+a".repeat(100_000)), "at most 16384");
    refused(&format!("{}1{}", "a+a*(".repeat(40), ")".repeat(40)), "numbers waiting");
    refused(&"x".repeat(16_000), "unknown name");
    let long = pure(&format!("a{}", "+a".repeat(2047)));
    assert!((long.evaluate(&[], &[0.5]) - 1024.0).abs() < 1e-9);
    assert!(long.tape.registers() <= 3);
    assert_eq!(pure(&long.to_string()), long);
    // With blanks the text would be too long to be read again.
    let name = "n".repeat(6);
    let text = format!("{name}{}", format!("+{name}").repeat(2047));
    let long = Expression::parse(&text, &[(&name, NONE)], NONE).unwrap();
    assert_eq!(Expression::parse(&long.to_string(), &[(&name, NONE)], NONE).unwrap(), long);
}

/// Random formulas over a, b, c and the variable eps.
fn formulas() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        3 => prop::sample::select(vec!["a", "b", "c", "eps", "pi"]).prop_map(str::to_owned),
        1 => (0.1..3.0_f64).prop_map(|x| format!("{x:.3}")),
        1 => (1..9_u8).prop_map(|x| format!("{x}0 [%]")),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let pair = (inner.clone(), inner.clone());
        let unary = prop::sample::select(vec![
            "sqrt", "exp", "ln", "log10", "sin", "cos", "tan", "asin", "atan", "tanh", "sinh", "cosh", "abs", "sign", "step",
        ]);
        prop_oneof![
            3 => (pair.clone(), prop::sample::select(vec!["+", "-", "*", "/", " - "]))
                .prop_map(|((a, b), sign)| format!("({a}{sign}{b})")),
            1 => (inner.clone(), prop::sample::select(vec!["+", "-", "*", "/"]), inner.clone())
                .prop_map(|(a, sign, b)| format!("{a}{sign}{b}")),
            2 => (unary, inner.clone()).prop_map(|(name, x)| format!("{name}({x})")),
            1 => inner.clone().prop_map(|x| format!("-({x})")),
            1 => (inner.clone(), prop::sample::select(vec!["2", "-1", "3", "0.5", "1.5", "(1/3)", "-0.7"]))
                .prop_map(|(x, power)| format!("({x})^{power}")),
            1 => pair.clone().prop_map(|(a, b)| format!("({a})^({b})")),
            1 => pair.clone().prop_map(|(a, b)| format!("max({a}, {b})")),
            1 => pair.prop_map(|(a, b)| format!("min({a}, {b}, 2*({a}))")),
            1 => (inner.clone(), inner.clone(), inner.clone()).prop_map(|(a, b, c)| format!("clamp({a}, {b}, {c})")),
            1 => (inner.clone(), inner.clone(), inner).prop_map(|(a, b, c)| format!("if({a} <= {b}, {c}, {a})")),
        ]
    })
}

fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let random = proptest::test_runner::TestRng::deterministic_rng(config.rng_algorithm);
    TestRunner::new_with_rng(config, random)
}

#[test]
fn random_formulas_are_written_and_read_back() {
    let check = |text: String| {
        // Random constants may give no finite value.
        let Ok(formula) = Expression::parse(&text, &[("a", NONE), ("b", NONE), ("c", NONE)], NONE) else {
            return Ok(());
        };
        let written = formula.to_string();
        let again = pure(&written);
        prop_assert_eq!(&again, &formula, "{} was written {}", text, written);
        prop_assert_eq!(again.to_string(), written);
        Ok(())
    };
    runner(3000).run(&formulas(), check).unwrap();
}

/// A difference quotient with the steps h and h/2, extrapolated to an error of order h^4.
fn extrapolated(f: &impl Fn(f64) -> f64, h: f64) -> f64 {
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    (4.0 * central(h / 2.0) - central(h)) / 3.0
}

#[test]
fn derivatives_agree_with_differences() {
    let (compared, kinks) = (std::cell::Cell::new(0), std::cell::Cell::new(0));
    let check = |(text, point): (String, [f64; 4])| {
        let Ok(formula) = Expression::parse(&text, &[("a", NONE), ("b", NONE), ("c", NONE)], NONE) else {
            return Ok(());
        };
        let at = |x: [f64; 4]| {
            let mut state = state();
            state[1] = x[3];
            formula.evaluate(&state, &x[..3])
        };
        let mut state = [Dual::<4>::from(0.0); VARIABLES.len()];
        let dual: [Dual<4>; 4] = std::array::from_fn(|i| Dual::variable(point[i], i));
        state[1] = dual[3];
        let found = formula.evaluate(&state, &dual[..3]);
        let value = at(point);
        if !value.is_finite() || value.abs() > 1e3 {
            return Ok(());
        }
        prop_assert!((found.value() - value).abs() <= 1e-10 * value.abs().max(1.0), "{}: {}", text, value);
        for (i, gradient) in found.gradient().iter().enumerate() {
            let along = |h: f64| {
                let mut x = point;
                x[i] += h;
                at(x)
            };
            let differences = [1e-3, 5e-4, 2.5e-4].map(|h| extrapolated(&along, h));
            let scale = gradient.abs().max(1.0) + value.abs();
            // If the differences haven't converged, a kink or a pole is near.
            let spread = (differences[0] - differences[2]).abs().max((differences[1] - differences[2]).abs());
            if !spread.is_finite() || spread > 2e-8 * scale {
                kinks.set(kinks.get() + 1);
                continue;
            }
            compared.set(compared.get() + 1);
            let apart = (gradient - differences[2]).abs();
            prop_assert!(apart <= 1e-6 * scale, "{}: d/d{} is {}, not {}", text, i, gradient, differences[2]);
        }
        Ok(())
    };
    let point = prop::array::uniform4(0.2..1.5_f64);
    runner(4000).run(&(formulas(), point), check).unwrap();
    let (compared, kinks) = (compared.get(), kinks.get());
    assert!(compared > 8000 && compared > 5 * kinks, "{compared} compared, {kinks} near kinks");
}
