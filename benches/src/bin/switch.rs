//! Times a diagnosis, and a comparison that is repeated with one effect more or less. The data are 1200
//! simulated rows of the clamped braid `dmsp-20-250`: loops at four pressures, and filling and venting at
//! four lengths. The effects in the data are rubber, and the friction that the test can show.
//!
//! `switch` prints one line per task: name, and the median of its seconds.

use bulge_benches::Failure;
use bulge_effects::{Catalogue, Effect};
use bulge_inference::{
    Block, Comparing, DiagnoseOptions, Options, Protocol, ReadingNoise, compare, diagnose, simulate_with,
};
use bulge_muscles::preset;
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 5;

fn median<T>(mut run: impl FnMut() -> Result<T, Failure>) -> Result<f64, Failure> {
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let answer = run()?;
        times.push(start.elapsed().as_secs_f64());
        drop(answer);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[ROUNDS / 2])
}

fn main() -> Result<(), Failure> {
    let catalogue = Catalogue::builtin();
    let muscle = preset("dmsp-20-250")?;
    let isobaric =
        Block { cycles: 3, rows: 100, ..Block::loops(vec![2e5, 3e5, 4e5, 5e5], [0.01, 0.2], 50.0) };
    let isometric =
        Block { cycles: 3, rows: 100, ..Block::isometric([0.8e5, 6e5], vec![0.02, 0.06, 0.1, 0.14], 20.0) };
    let noise = ReadingNoise { force_n: 1.2, ..ReadingNoise::default() };
    for (name, block, friction) in
        [("isobaric", isobaric, "coulomb-friction"), ("isometric", isometric, "pressure-presliding")]
    {
        let protocol = Protocol { noise, pause_s: 10.0, ..Protocol::new(vec![block]) };
        let hidden = ["bladder-elasticity", friction].map(str::to_owned);
        let test = simulate_with(&muscle, &catalogue, &protocol, &hidden, 1)?;
        let (data, muscle) = (&test.data, &test.muscle);
        let options = Options::new(catalogue.clone(), Vec::new());
        let chosen = |names: &[&str]| -> Result<Vec<Arc<dyn Effect>>, Failure> {
            Ok(names.iter().map(|name| catalogue.find(name).cloned()).collect::<Result<_, _>>()?)
        };
        let both = chosen(&["bladder-elasticity", friction])?;
        let all = Options { effects: both.clone(), ..options.clone() };
        let time = median(|| Ok(compare(data, muscle, &all)?))?;
        println!("{name}, {} rows: compare with both, once\t{time:.4}", data.len());
        let time = median(|| Ok(Comparing::new(data, muscle, &options)?))?;
        println!("{name}: the base\t{time:.4}");
        for (on, from) in [
            ("bladder-elasticity", &[][..]),
            (friction, &[][..]),
            (friction, &["bladder-elasticity"][..]),
            ("end-taper", &["bladder-elasticity", friction][..]),
        ] {
            let before = chosen(from)?;
            let after = chosen(&[from, &[on][..]].concat())?;
            let mut times = Vec::new();
            for _ in 0..ROUNDS {
                let comparing = Comparing::new(data, muscle, &options)?;
                comparing.with(&before, &[])?;
                let start = Instant::now();
                comparing.with(&after, &[])?;
                times.push(start.elapsed().as_secs_f64());
            }
            times.sort_by(f64::total_cmp);
            println!("{name}: {on} on, with {} before\t{:.4}", from.join(" and "), times[ROUNDS / 2]);
        }
        let comparing = Comparing::new(data, muscle, &options)?;
        comparing.with(&both, &[])?;
        let time = median(|| Ok(comparing.with(&both[..1], &[])?))?;
        println!("{name}: {friction} off\t{time:.4}");
        let options = DiagnoseOptions::new(options.clone());
        let time = median(|| Ok(diagnose(data, muscle, &options)?))?;
        println!("{name}: diagnose\t{time:.4}");
    }
    Ok(())
}
