//! x
use bulge_sweep::plan::*; use bulge_sweep::*; use bulge_muscles::preset; use bulge_fibre::Approach;
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    let ax = |q: Quantity, n: &str, f: f64, t: End| Axis { quantity: q, name: n.into(), unit: "1".into(), range: Range::Between { from: f, to: t, points: None, spacing: Spacing::Linear } };
    let plan = Plan { name: "x".into(), muscle: preset("ppam-2-r16").unwrap(), pressure_pa: 1e5, contraction: None, approach: Approach::Auto,
        axes: vec![ax(Quantity::Contraction, "contraction", 0.0, End::Limit), ax(Quantity::Slenderness, "slenderness", a[0], End::Value(a[1]))],
        design: None, outputs: vec![Output::ForceF, Output::VolumeV], chunk: 1, table: None };
    let w = TableWish { outputs: plan.outputs.clone(), tolerance: a[2], gradient: a[3], max_bytes: 65536, form: TableForm::Fastest, checks: 131072 };
    let field = MuscleField::new(&plan, &w).unwrap();
    for form in [TableForm::Splines, TableForm::Chebyshev] {
        let t = std::time::Instant::now();
        let b = build(&field, &Wish { tolerance: w.tolerance, gradient: w.gradient, max_bytes: 65536, form, checks: w.checks, text: "{}".into() }, &|s| eprintln!("{s} {:?}", t.elapsed())).unwrap();
        let tab = bulge_table::Table::from_bytes(&b.bytes).unwrap();
        println!("{:?} {} bytes {} met {} {:?} edge {:e}", tab.form(), tab.precision(), b.bytes.len(), b.is_met, t.elapsed(), tab.edge_error());
        for i in 0..2 { println!("{:?}", tab.axis(i)); println!("{:?}", b.certificates[i]); }
    }
}
