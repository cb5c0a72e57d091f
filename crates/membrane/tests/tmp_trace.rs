//! x
#[test]
fn t() {
    let text = std::fs::read_to_string("/tmp/mb/airbag80.toml").unwrap();
    for r in ["1e-2", "1e-3", "1e-4", "1e-5"] {
        let text = text.replace("poisson = 0.4", &format!("poisson = 0.4\nresidual = {r}"));
        let case = bulge_membrane::case::Case::from_toml(&text, "a", None).unwrap();
        let mut run = case.start().unwrap();
        let e = run.last_row(|_| ());
        println!("{r} {:?} {:?}", e.map(|r| (r.iterations, r.volume, r.unstable)), run.effort());
    }
}
