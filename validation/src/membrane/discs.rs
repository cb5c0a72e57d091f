//! Flat discs by elements of revolution, held at the rim or joined to another disc.

use bulge_membrane::mesher::{Grading, revolved};
use bulge_membrane::{
    Block, CellKind, Cloth, Inflation, Law, Mesh, Part, RingLayer, Sheet, Solver, State, Support, Thread,
};
use core::f64::consts::{FRAC_PI_2, TAU};

use super::rig::{extreme, order, plane, rubber, solver, to};
use crate::check::{Check, Claim, Trouble};

/// A disc of radius 1, meshed from its rim to its middle.
fn disc(part: Part, rim: Support, elements: usize) -> Result<Solver, Trouble> {
    let mesh = revolved(|t| [1.0 - t, 0.0], elements, true, Grading::Even);
    let along = if rim == Support::Fixed { 1.0 } else { 2.0 };
    solver(&mesh, &[("wall", part)], &[("first", rim), ("last", Support::Axis)], &[], [1.0, along])
}

/// Height of the middle.
fn height(disc: &mut Solver, state: &State) -> f64 {
    disc.fields(state).places.last().map_or(f64::NAN, |place| place[2])
}

/// Small pressures.
pub(crate) fn hencky() -> Check {
    Claim {
        group: "membrane",
        name: "flat disc at p a/(Y h) = 1e-5, nu = 0.2 to 0.4: height, volume, force in the middle and at the rim",
        source: "Hencky's series",
        tolerance: 1e-3,
        why: "the series is the limit of small pressures; 30 quadratic elements",
    }
    .run(|tally| {
        let p = 1e-5_f64;
        for [poisson, kw, k0, ka, kv] in [
            [0.2, 0.677_435_325_805, 0.420_683_090_434, 0.316_109_288_5, 1.114_377_953_41],
            [0.3, 0.653_443_344_693, 0.431_101_016_110, 0.332_956_806_9, 1.070_316_686_50],
            [0.34, 0.642_998_037_074, 0.435_966_558_463, 0.340_589_787_7, 1.051_318_242_33],
            [0.4, 0.626_255_079_364, 0.444_217_658_946, 0.353_232_745_1, 1.021_090_857_91],
        ] {
            let part = rubber(Law::SaintVenantKirchhoff { stiffness: 1.0, poisson });
            let mut disc = disc(part, Support::Fixed, 30)?;
            let rest = disc.at_rest();
            let state = to(&mut disc, &rest, Inflation::Pressure(p), &[])?;
            let sheets = &disc.fields(&state).groups[0].sheets[0];
            // Extrapolation from the middles of the outermost elements to the rim.
            let rim = 1.5 * sheets[0].force[0] - 0.5 * sheets[1].force[0];
            let case = |what: &str| format!("{what}, nu = {poisson}");
            tally.relative(height(&mut disc, &state), kw * p.cbrt(), || case("height"));
            tally.relative(state.volume, kv * p.cbrt(), || case("volume"));
            tally.relative(sheets[29].force[0], k0 * (p * p).cbrt(), || case("force in the middle"));
            tally.relative(rim, ka * (p * p).cbrt(), || case("force at the rim"));
        }
        Ok(())
    })
}

/// Large stretches.
pub(crate) fn rubber_discs() -> Check {
    Claim {
        group: "membrane",
        name: "disc of neo-Hookean and Mooney-Rivlin rubber blown up: pressure at four heights, largest pressure",
        source: "shooting (Adkins and Rivlin's problem), 9 digits",
        tolerance: 1e-6,
        why: "80 quadratic elements: fourth order",
    }
    .run(|tally| {
        let mooney = Law::MooneyRivlin { c1: 0.5 / 1.1, c2: 0.05 / 1.1 };
        let neo_hooke = Law::NeoHooke { shear: 1.0 };
        // p A/(mu H) and w/A.
        let of_neo_hooke = [
            [0.527_781_922, 0.383_472_429],
            [1.643_581_841, 0.798_789_213],
            [1.869_554_748, 1.083_067_162],
            [1.864_578_897, 1.302_007_729],
        ];
        let of_mooney = [
            [0.540_520_902, 0.385_442_027],
            [1.819_418_924, 0.822_324_896],
            [2.245_900_737, 1.161_125_160],
            [2.415_896_761, 1.473_641_873],
        ];
        for (name, law, table) in [("neo-Hooke", neo_hooke, of_neo_hooke), ("Mooney-Rivlin", mooney, of_mooney)]
        {
            let mut disc = disc(rubber(law), Support::Fixed, 80)?;
            let rest = disc.at_rest();
            let mut state = to(&mut disc, &rest, Inflation::Pressure(0.1), &[])?;
            for [pressure, wanted] in table {
                // The volume at which the middle has the wanted height, by secants.
                let (mut a, mut there) = (state.volume, height(&mut disc, &state));
                let mut volume = a * wanted / there;
                for _ in 0..12 {
                    state = to(&mut disc, &state, Inflation::Volume(volume), &[])?;
                    let now = height(&mut disc, &state);
                    if (now - wanted).abs() < 1e-11 {
                        break;
                    }
                    (a, volume, there) = (volume, volume - (now - wanted) * (volume - a) / (now - there), now);
                }
                tally.relative(state.pressure, pressure, || format!("pressure, {name}, height {wanted}"));
            }
            if name == "neo-Hooke" {
                let [_, largest] = extreme(0.8 * state.volume, |volume| {
                    state = to(&mut disc, &state, Inflation::Volume(volume), &[])?;
                    Ok(state.pressure)
                })?;
                tally.relative(largest, 1.879_173_469, || "largest pressure".into());
            }
        }
        Ok(())
    })
}

/// Volume and thickness of the Mylar balloon of two discs of radius 1.
const MYLAR: [f64; 2] = [1.218_524_216_118_569_7, 0.913_893_162_088_927_2];

/// Two discs that are inextensible along their radii and joined at their rims.
pub(crate) fn mylar() -> Check {
    Claim {
        group: "membrane",
        name: "Mylar balloon: volume and thickness",
        source: "gamma functions",
        tolerance: 1e-5,
        why: "80 quadratic elements, a film of 1e-6 of its stiffness around",
    }
    .run(|tally| {
        let law = Law::SaintVenantKirchhoff { stiffness: 1.0, poisson: 0.3 };
        let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-6 };
        let threads = RingLayer::Threads { thread: Thread::Inextensible, count: 40.0, angle: 0.0 };
        let part = Part::Revolved { layers: vec![threads, RingLayer::Sheet { sheet, fullness: 1.0 }] };
        let balloon = disc(part, plane([0.0, 0.0, 1.0]), 80)?;
        let [volume, thickness] = inflated(balloon, 160)?;
        tally.relative(volume, MYLAR[0], || "volume".into());
        tally.relative(thickness, MYLAR[1], || "thickness".into());
        Ok(())
    })
}

/// One of `around` sectors of a flat disc of radius 1. Its rings are denser at the rim, and each has two
/// triangles on both sides of the middle of the sector. Groups: foil, rim, first, last.
fn sector(around: f64, rings: usize) -> Mesh {
    let mut nodes = vec![[0.0; 3]];
    let mut cells = Vec::new();
    for ring in 0..rings {
        let radius = (FRAC_PI_2 * (ring + 1) as f64 / rings as f64).sin();
        let angles = [0.0, 0.5, 1.0].map(|part| part * TAU / around);
        nodes.extend(angles.map(|angle: f64| [radius * angle.cos(), radius * angle.sin(), 0.0]));
        let [a, b, c] = [0, 1, 2].map(|side| 3 * ring + 1 + side);
        match ring {
            0 => cells.extend([0, a, b, 0, b, c]),
            // Both diagonals start at the middle of the inner ring.
            _ => cells.extend([a - 3, a, b - 3, a, b, b - 3, c, c - 3, b - 3, c, b - 3, b]),
        }
    }
    let side = |first: usize| (first..nodes.len()).step_by(3).collect::<Vec<_>>();
    let [first, last] = [[vec![0], side(1)].concat(), [vec![0], side(3)].concat()];
    let rim = (nodes.len() - 3..nodes.len()).collect();
    let block = |group: &str, kind: CellKind, cells: Vec<usize>| Block {
        group: group.to_owned(),
        kind,
        numbers: (0..cells.len() as u64 / kind.nodes() as u64).collect(),
        cells,
        pattern: None,
    };
    let points = |group: &str, cells: Vec<usize>| block(group, CellKind::Point, cells);
    let blocks = vec![
        block("foil", CellKind::Triangle3, cells),
        points("rim", rim),
        points("first", first),
        points("last", last),
    ];
    Mesh { numbers: (0..nodes.len() as u64).collect(), nodes, blocks }
}

/// A film under the pressure 1 that carries load only where it is taut.
fn film() -> Sheet {
    let law = Law::SaintVenantKirchhoff { stiffness: 1e4, poisson: 0.3 };
    Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-6 }
}

/// Volume and thickness of the inflated balloon, starting from rest.
fn inflated(mut balloon: Solver, middle: usize) -> Result<[f64; 2], Trouble> {
    let rest = balloon.at_rest();
    let state = to(&mut balloon, &rest, Inflation::Pressure(1.0), &[])?;
    Ok([state.volume, 2.0 * balloon.fields(&state).places[middle][2]])
}

/// The balloon by triangles: `rings` rings in one of 3.2 times as many sectors.
fn of_triangles(rings: usize) -> Result<[f64; 2], Trouble> {
    let around = 3.2 * rings as f64;
    let turn = TAU / around;
    let supports = [
        ("rim", plane([0.0, 0.0, 1.0])),
        ("first", plane([0.0, 1.0, 0.0])),
        ("last", plane([-turn.sin(), turn.cos(), 0.0])),
    ];
    let part = Part::Membrane { sheet: Some(film()), warp: [1.0, 0.0, 0.0] };
    inflated(solver(&sector(around, rings), &[("foil", part)], &supports, &[], [around, 2.0])?, 0)
}

/// The Mylar balloon by triangles in space. A narrow sector is used because a whole disc of slack cloth has
/// lobed equilibria besides the one of revolution.
pub(crate) fn mylar_of_triangles() -> Check {
    Claim {
        group: "membrane",
        name: "Mylar balloon by triangles, Y h = 1e4 p a, in narrow sectors: volume and thickness",
        source: "gamma functions",
        tolerance: 1e-3,
        why: "238 and 318 triangles in one of 192 and 256 sectors; the stretch of the film adds 8e-4 to the thickness",
    }
    .run(|tally| {
        for rings in [60, 80] {
            let [volume, thickness] = of_triangles(rings)?;
            tally.relative(volume, MYLAR[0], || format!("volume, {rings} rings"));
            tally.relative(thickness, MYLAR[1], || format!("thickness, {rings} rings"));
        }
        Ok(())
    })
}

/// Order with which the volume tends to that of the same film by elements of revolution.
pub(crate) fn order_of_mylar() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the Mylar balloon's volume by triangles: 2",
        source: "160 quadratic elements of revolution of the same film",
        tolerance: 0.05,
        why: "10 to 80 rings, twice as many each",
    }
    .run(|tally| {
        let layers = vec![RingLayer::Sheet { sheet: film(), fullness: 1.0 }];
        let revolved = disc(Part::Revolved { layers }, plane([0.0, 0.0, 1.0]), 160)?;
        let exact = inflated(revolved, 320)?;
        let errors = [10, 20, 40, 80].map(|rings| Ok(exact[0] - of_triangles(rings)?[0]));
        order(tally, "volume", &errors.into_iter().collect::<Result<Vec<f64>, Trouble>>()?, 2.0);
        Ok(())
    })
}
