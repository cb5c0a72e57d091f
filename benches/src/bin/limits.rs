//! What each kernel costs beside what its mathematics needs: a roofline.
//!
//! ```sh
//! cargo run --release -p bulge-benches --bin limits > benches/limits.json
//! python3 validation/docs_table.py limits                                   # the table, into docs/speed.md
//! ```
//!
//! Operations are counted in the formulas that are used, by hand, to some ten per cent. The rates of the machine are measured
//! in the same run, each by a loop whose numbers stay in registers: as this program is compiled (two lanes of SSE2) and in
//! four lanes of AVX2 where the processor has it, both without fused multiplication and addition, whose results are others. The
//! limit of a kernel is the longer of its additions and multiplications on one hand, and of its divisions and roots, which
//! share a unit, on the other; or what its numbers take from and to memory, if they didn't stay in a cache:
//!
//! ```text
//! limit = max(arithmetic t_a, divisions t_d + roots t_r, bytes t_b)
//! ```
//! t_b is that of a copy of [`COPIED`] numbers by one thread, what is read and written.
//!
//! Beside it stands the fastest of other libraries, timed in the same run by `benches/peers/limits.py`, where `python3` has SciPy.
//!
//! Instructions are counted by `valgrind --tool=callgrind` in two runs of this program, one with twice as many calls, where
//! valgrind is there. Virtual machines seldom have the counters of `perf`.

#![expect(
    clippy::inline_always,
    reason = "what isn't inlined into the dispatch isn't compiled for its lanes"
)]

use bulge_benches::{Failure, SLENDERNESS, braid, median_us, pleated, random_points, solve};
use bulge_fibre::{Approach, Problem, closed_form};
use bulge_membrane::case::Case;
use bulge_numerics::Random;
use bulge_numerics::elliptic::{duplications, incomplete};
use bulge_sweep::{Plan, tabulate};
use bulge_table::Table;
use serde_json::{Value, json};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;

const FAMILY: &str = include_str!("../../../crates/cli/data/family.toml");
/// Numbers in a loop that measures a rate: fourteen of the sixteen registers, of two lanes and of four.
const PLAIN: usize = 28;
const WIDE: usize = 56;
/// Operations on each number in such a loop.
const LOOPS: usize = 10_000;
/// Points of a kernel: more than branch predictors learn.
const POINTS: usize = 4096;
const ROUNDS: usize = 15;

/// Operations that a formula needs.
#[derive(Debug, Clone, Copy)]
struct Operations {
    /// Additions and multiplications.
    arithmetic: f64,
    divisions: f64,
    roots: f64,
    /// Bytes that are read or written: arguments, coefficients and results, each once.
    bytes: f64,
}

impl Operations {
    const NONE: Self = Self { arithmetic: 0.0, divisions: 0.0, roots: 0.0, bytes: 0.0 };

    fn with_bytes(self, bytes: f64) -> Self {
        Self { bytes, ..self }
    }

    fn times(self, factor: f64) -> Self {
        Self {
            arithmetic: self.arithmetic * factor,
            divisions: self.divisions * factor,
            roots: self.roots * factor,
            bytes: self.bytes * factor,
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            arithmetic: self.arithmetic + other.arithmetic,
            divisions: self.divisions + other.divisions,
            roots: self.roots + other.roots,
            bytes: self.bytes + other.bytes,
        }
    }
}

/// One operation, of which many are independent.
trait Operation {
    fn on(x: f64) -> f64;
}

struct MultiplyAndAdd;
struct Divide;
struct Root;

// Numbers stay ordinary, and no root is exact, which would be faster.
impl Operation for MultiplyAndAdd {
    #[inline(always)]
    fn on(x: f64) -> f64 {
        x * 0.75 + 0.25
    }
}

impl Operation for Divide {
    #[inline(always)]
    fn on(x: f64) -> f64 {
        1.000_1 / x
    }
}

impl Operation for Root {
    #[inline(always)]
    fn on(x: f64) -> f64 {
        (x + 1.5).sqrt()
    }
}

#[inline(always)]
fn repeat<O: Operation, const N: usize>(numbers: &mut [f64; N]) {
    for _ in 0..LOOPS {
        for x in numbers.iter_mut() {
            *x = O::on(*x);
        }
    }
}

/// Nanoseconds of one operation as compiled.
fn plain<O: Operation>() -> f64 {
    let mut numbers = std::array::from_fn::<f64, PLAIN, _>(|i| 1.0 + 1e-3 * i as f64);
    1e3 * median_us(ROUNDS, LOOPS * PLAIN, || repeat::<O, PLAIN>(black_box(&mut numbers)))
}

/// The same in lanes of AVX2, where the processor has them.
fn wide<O: Operation>() -> f64 {
    let mut numbers = std::array::from_fn::<f64, WIDE, _>(|i| 1.0 + 1e-3 * i as f64);
    let arch = pulp::Arch::new();
    let mut run = || {
        let numbers = black_box(&mut numbers);
        arch.dispatch(
            #[inline(always)]
            || repeat::<O, WIDE>(numbers),
        );
    };
    1e3 * median_us(ROUNDS, LOOPS * WIDE, &mut run)
}

/// Nanoseconds of one operation where many are independent.
#[derive(Debug, Clone, Copy)]
struct Rates {
    arithmetic: f64,
    division: f64,
    root: f64,
    byte: f64,
}

/// Numbers that are copied to measure the memory's rate: ten times what caches hold.
const COPIED: usize = 1 << 24;

/// Nanoseconds of a byte from memory or to it.
fn copied() -> f64 {
    let (from, mut to) = (vec![1.0_f64; COPIED], vec![0.0_f64; COPIED]);
    1e3 * median_us(5, 16 * COPIED, || black_box(&mut to).copy_from_slice(black_box(&from)))
}

impl Rates {
    fn as_compiled(byte: f64) -> Self {
        Self {
            arithmetic: 0.5 * plain::<MultiplyAndAdd>(),
            division: plain::<Divide>(),
            root: plain::<Root>(),
            byte,
        }
    }

    fn in_lanes(byte: f64) -> Self {
        let arithmetic = 0.5 * wide::<MultiplyAndAdd>();
        Self { arithmetic, division: wide::<Divide>(), root: wide::<Root>(), byte }
    }

    /// Nanoseconds that operations take at least.
    fn limit(&self, needed: &Operations) -> f64 {
        let arithmetic = needed.arithmetic * self.arithmetic;
        let divider = needed.divisions * self.division + needed.roots * self.root;
        arithmetic.max(divider).max(needed.bytes * self.byte)
    }
}

/// A kernel: what a call of it needs, and calls of it.
struct Kernel {
    name: &'static str,
    /// Where the counted operations come from.
    counted: &'static str,
    needed: Operations,
    /// Makes so many calls.
    calls: Box<dyn FnMut(usize)>,
    /// Calls that are timed, and whose instructions are counted: some 10^7 of them.
    traced: usize,
}

/// A pair of elliptic integrals after so many duplications.
fn pair(duplications: f64) -> Operations {
    // lambda, the sum, four means.
    let duplication = Operations { arithmetic: 16.0, divisions: 1.0, roots: 3.0, ..Operations::NONE };
    // Both series, the arguments, the factors in front.
    let series = Operations { arithmetic: 88.0, divisions: 2.0, roots: 2.0, ..Operations::NONE };
    duplication.times(duplications).and(series)
}

/// The start of the closed form: an inverse tangent and two polynomials of 36 terms.
const BEGIN: Operations = Operations { arithmetic: 190.0, divisions: 3.0, roots: 3.0, ..Operations::NONE };
/// An iteration of Newton's method in the closed form beside its pair: residuals, Jacobian, step. Logarithms and exponentials
/// of numbers near one are ratios.
const NEWTON: Operations = Operations { arithmetic: 84.0, divisions: 13.0, roots: 1.0, ..Operations::NONE };
/// Force, volume and radius with their derivatives by contraction, slenderness and compliance.
const OUTPUTS: Operations = Operations { arithmetic: 150.0, divisions: 4.0, roots: 1.0, ..Operations::NONE };
/// Pairs that an equilibrium needs: one that corrects a start good to six digits, and one whose derivatives correct the
/// answer to sixteen.
const PAIRS: f64 = 2.0;
/// A point of the meridian's quadrature without derivatives and with those by two unknowns, whose divisions and roots are
/// products: the divided differences, the rates of length, shortening and volume, and their sums. The places are a table's.
const BRAID: [Operations; 2] = [
    Operations { arithmetic: 48.0, divisions: 6.0, roots: 2.0, ..Operations::NONE },
    Operations { arithmetic: 247.0, divisions: 6.0, roots: 2.0, ..Operations::NONE },
];
/// The same of straight fibres: sigma is one.
const STRAIGHT: [Operations; 2] = [
    Operations { arithmetic: 33.0, divisions: 3.0, roots: 1.0, ..Operations::NONE },
    Operations { arithmetic: 150.0, divisions: 3.0, roots: 1.0, ..Operations::NONE },
];
/// Splines of 4 x 4 coefficients for two outputs: two bases with slopes (32), values and slopes along the rows and their sums
/// across (144), the edge's spline (33), the coordinates and the chain rule (65). Its bytes: the coefficients, two coordinates,
/// two values with two slopes each.
const SPLINE: Operations = Operations { arithmetic: 274.0, divisions: 3.0, roots: 1.0, bytes: 320.0 };
/// The tangent of a flat triangle of three nodes: metric and strain (39), a stress with its three by three moduli (60), B (45),
/// its forces (54), B^T D B (nine by nine, symmetric: 432), the stress's own part (40), that of the pressure (60), and the
/// sums over elements (115). Its bytes: three places (72), the flat shape (80), energy, volume, forces and stiffness written and
/// read once more to be summed (2 x 8 x (2 + 18 + 45)) with their sources.
const TRIANGLE: Operations = Operations { arithmetic: 845.0, divisions: 2.0, roots: 1.0, bytes: 1450.0 };

fn elliptic(name: &'static str) -> Kernel {
    let mut random = Random::new(1, 0);
    let arguments: Vec<[f64; 2]> =
        (0..POINTS).map(|_| [3.0 * random.uniform(), 0.5 * random.uniform()]).collect();
    let mean = arguments.iter().map(|[t, m]| f64::from(duplications(*t, *m))).sum::<f64>() / POINTS as f64;
    let mut next = 0;
    Kernel {
        name,
        counted: "Carlson's duplications until the series are exact",
        needed: pair(mean).with_bytes(32.0),
        calls: Box::new(move |count| {
            for _ in 0..count {
                next = (next + 1) % POINTS;
                let [t, m] = arguments[next];
                black_box(incomplete(black_box(t), m));
            }
        }),
        traced: 50_000,
    }
}

fn closed(name: &'static str, in_one_call: bool) -> Kernel {
    let mut random = Random::new(2, 0);
    let contractions: Vec<f64> = (0..POINTS).map(|_| 0.05 + 0.35 * random.uniform()).collect();
    let found = contractions.iter().filter_map(|e| closed_form::solve(*e, SLENDERNESS, 0.0).ok());
    let mean = found.map(|found| f64::from(duplications(found.t, found.m))).sum::<f64>() / POINTS as f64;
    let asked: Vec<[f64; 3]> = contractions.iter().map(|e| [*e, SLENDERNESS, 0.0]).collect();
    let mut next = 0;
    let one_by_one = move |count: usize| {
        for _ in 0..count {
            next = (next + 1) % POINTS;
            let _ = black_box(closed_form::solve(black_box(contractions[next]), SLENDERNESS, 0.0));
        }
    };
    let many = move |count: usize| {
        for first in (0..count).step_by(POINTS) {
            black_box(closed_form::solve_many(black_box(&asked[..POINTS.min(count - first)])));
        }
    };
    Kernel {
        name,
        counted: "a start, two pairs, each in an iteration of Newton's method",
        // Three numbers in; force, volume, radius, unknowns and their derivatives out.
        needed: pair(mean).and(NEWTON).times(PAIRS).and(BEGIN).and(OUTPUTS).with_bytes(160.0),
        calls: if in_one_call { Box::new(many) } else { Box::new(one_by_one) },
        traced: 10_000,
    }
}

/// An equilibrium by shooting: two passes over so many nodes, one of them with derivatives.
fn shot(
    name: &'static str,
    (problem, approach): (Problem, Approach),
    node: [Operations; 2],
    nodes: f64,
    traced: usize,
) -> Kernel {
    Kernel {
        name,
        counted: "two passes over the nodes of one or two pieces, one of them with two derivatives, and no check",
        // Two numbers of a table each, in both passes.
        needed: node[0].and(node[1]).times(nodes).with_bytes(32.0 * nodes),
        calls: Box::new(move |count| {
            for i in 0..count {
                let contraction = 0.05 + 0.2 * (i % 64) as f64 / 63.0;
                let _ = black_box(solve(&problem, black_box(contraction), approach));
            }
        }),
        traced,
    }
}

/// The table that the tour ships.
fn build(table: &Path) -> Result<(), Failure> {
    let plan = Plan::from_toml(FAMILY, "family.toml", None)?;
    let wish = plan.table.as_ref().ok_or("no table is wished")?;
    std::fs::write(table, tabulate(&plan, wish, &|_| ())?.bytes)?;
    Ok(())
}

/// Lookups in a table.
fn looked_up(name: &'static str, table: &Path, in_one_call: bool) -> Result<Kernel, Failure> {
    let bytes: &'static [u8] = Vec::leak(std::fs::read(table)?);
    let lookup = Table::from_bytes(bytes)?.lookup::<2, 2>()?;
    let points = random_points(&lookup, POINTS);
    let mut found = vec![None; POINTS];
    let mut next = 0;
    let one_by_one = {
        let points = points.clone();
        move |count: usize| {
            for _ in 0..count {
                next = (next + 1) % POINTS;
                black_box(lookup.at(black_box(points[next])));
            }
        }
    };
    let many = move |count: usize| {
        for first in (0..count).step_by(POINTS) {
            let some = POINTS.min(count - first);
            lookup.at_each(black_box(&points[..some]), &mut found[..some]);
            black_box(&found);
        }
    };
    Ok(Kernel {
        name,
        counted: "two splines of 4 x 4 coefficients with gradients",
        needed: SPLINE,
        calls: if in_one_call { Box::new(many) } else { Box::new(one_by_one) },
        traced: 4 * POINTS,
    })
}

/// Makes a kernel of a name, with the file of a table.
type Maker = fn(&'static str, &Path) -> Result<Kernel, Failure>;
const KERNELS: [(&str, Maker); 8] = [
    ("pair of elliptic integrals", |name, _| Ok(elliptic(name))),
    ("equilibrium in closed form", |name, _| Ok(closed(name, false))),
    ("equilibrium in closed form, many in one call", |name, _| Ok(closed(name, true))),
    ("clamped braid, l0/r0 = 25", |name, _| Ok(shot(name, (braid(25.0)?, Approach::Auto), BRAID, 42.0, 300))),
    ("clamped braid, l0/r0 = 25, checked by an integration of the ODE", |name, _| {
        Ok(shot(name, (braid(25.0)?, Approach::Shooting), BRAID, 42.0, 300))
    }),
    ("pleated muscle by shooting, checked by an integration of the ODE", |name, _| {
        Ok(shot(name, (pleated(None)?, Approach::Shooting), STRAIGHT, 21.0, 1000))
    }),
    ("lookup, one by one", |name, table| looked_up(name, table, false)),
    ("lookup, many in one call", |name, table| looked_up(name, table, true)),
];

/// Instructions of one call of a kernel, as valgrind counts them in two runs of this program. None without it.
fn instructions(kernel: &Kernel, table: &Path) -> Option<f64> {
    let count = |calls: usize| -> Option<f64> {
        let run = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe().ok()?)
            .args(["--calls", kernel.name, &calls.to_string()])
            .arg(table)
            .output()
            .ok()?;
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        said.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
    };
    Some((count(2 * kernel.traced)? - count(kernel.traced)?) / kernel.traced as f64)
}

/// What computes a kernel fastest elsewhere, and its nanoseconds; nothing without SciPy, and the reason on standard error.
fn peers() -> Vec<(String, String, f64)> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/limits.py");
    let run = match Command::new("python3").arg(script).output() {
        Ok(run) if run.status.success() => run,
        found => {
            let why = found.map_or_else(|e| e.to_string(), |run| String::from_utf8_lossy(&run.stderr).into());
            eprintln!("no peers: {}", why.trim().lines().last().unwrap_or("python3 failed"));
            return Vec::new();
        }
    };
    let row = |line: &str| {
        let mut cells = line.split('\t').map(str::to_owned);
        Some((cells.next()?, cells.next()?, cells.next()?.parse().ok()?))
    };
    String::from_utf8_lossy(&run.stdout).lines().filter_map(row).collect()
}

/// Triangles of the square airbag and its factors: nanoseconds of one in an iteration, nanoseconds of a
/// factor, the operations that a factor with so many entries needs at least, sum c_j^2 >= (sum c_j)^2/n of its columns, and its
/// bytes, each entry written and read.
fn membrane() -> Result<[f64; 4], Failure> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../meshes/airbag.toml");
    // Odd numbers of cells have no coarser mesh to start from, whose iterations would count.
    let text = std::fs::read_to_string(&path)?.replace("[40, 40]", "[41, 39]");
    let case = Case::from_toml(&text, "airbag.toml", path.parent())?;
    let mut run = case.start()?;
    run.last_row(|_| ())?;
    let effort = run.effort();
    let [unknowns, _, factors] = run.sizes();
    let elements = run.elements() as f64 * effort.iterations as f64;
    let least = (factors as f64).powi(2) / unknowns as f64;
    let tangent = effort.assembling.as_secs_f64() / elements;
    let factor = effort.factorising.as_secs_f64() / effort.factorisations as f64;
    Ok([1e9 * tangent, 1e9 * factor, least, 16.0 * factors as f64])
}

fn measured(table: &Path) -> Result<Value, Failure> {
    let byte = copied();
    let [compiled, lanes] = [Rates::as_compiled(byte), Rates::in_lanes(byte)];
    let peers = peers();
    let mut rows = Vec::new();
    let row = |name: &str, counted: &str, needed: &Operations, time_ns: f64, instructions: Option<f64>| {
        let peer = peers.iter().find(|(kernel, ..)| kernel == name);
        json!({
            "kernel": name,
            "counted": counted,
            "arithmetic": needed.arithmetic,
            "divisions": needed.divisions,
            "roots": needed.roots,
            "bytes": needed.bytes,
            "instructions": instructions,
            "time_ns": time_ns,
            "compiled_ns": compiled.limit(needed),
            "lanes_ns": lanes.limit(needed),
            "peer": peer.map(|(_, peer, _)| peer),
            "peer_ns": peer.map(|(.., ns)| ns),
        })
    };
    for (name, maker) in KERNELS {
        let mut kernel = maker(name, table)?;
        let time = 1e3 * median_us(ROUNDS, kernel.traced, || (kernel.calls)(kernel.traced));
        rows.push(row(kernel.name, kernel.counted, &kernel.needed, time, instructions(&kernel, table)));
    }
    let [tangent, factor, least, bytes] = membrane()?;
    rows.push(row(
        "an iteration of an airbag, per triangle",
        "its tangent and the sums; the line search has energies besides",
        &TRIANGLE,
        tangent,
        None,
    ));
    let needed = Operations { arithmetic: least, bytes, ..Operations::NONE };
    rows.push(row(
        "factor of an airbag of 3200 triangles",
        "at least the square of its entries over its columns",
        &needed,
        factor,
        None,
    ));
    let rates = |rates: &Rates| {
        json!({
            "arithmetic_ns": rates.arithmetic,
            "division_ns": rates.division,
            "root_ns": rates.root,
            "byte_ns": rates.byte,
        })
    };
    Ok(json!({
        "command": "cargo run --release -p bulge-benches --bin limits > benches/limits.json",
        "compiled": rates(&compiled),
        "lanes": rates(&lanes),
        "rows": rows,
    }))
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [flag, asked, calls, table] = &arguments[..] {
        let known = KERNELS.into_iter().find(|(name, _)| flag == "--calls" && name == asked);
        let (name, maker) = known.ok_or("write `limits` alone")?;
        (maker(name, Path::new(table))?.calls)(calls.parse()?);
        return Ok(());
    }
    let table = std::env::temp_dir().join(format!("bulge-limits-{}.bulge", std::process::id()));
    build(&table)?;
    let found = measured(&table);
    std::fs::remove_file(&table)?;
    println!("{}", serde_json::to_string_pretty(&found?)?);
    Ok(())
}
