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
        std::fs::write(format!("/tmp/ppam-{}.table", tab.form().code()), &b.bytes).unwrap(); let lk=tab.lookup::<2,2>().unwrap(); let pts: Vec<[f64;2]>=(0..4096u32).map(|i| { let l=2.0+98.0*(f64::from(i)*0.618_033_988_7).fract(); [ ((f64::from(i)*0.754_877_666).fract()*0.95+0.01)*lk.upper_end([0.0,l]).unwrap(), l] }).collect(); let t=std::time::Instant::now(); let mut sum=0.0; for _ in 0..200 { for p in &pts { let [f,v]=lk.at(std::hint::black_box(*p)).unwrap(); sum+=f.value+v.gradient[1]+f.gradient[0]+f.gradient[1]+v.value+v.gradient[0]; } } println!("lookup {:?} {sum}", t.elapsed()/(200*4096));
        for i in 0..2 { println!("{:?}", tab.axis(i)); println!("{:?}", b.certificates[i]); }
    }
}
