//! x
fn main() { let a: Vec<String> = std::env::args().collect(); let plan = bulge_sweep::Plan::read(&a[1]).unwrap(); let t=std::time::Instant::now();
 let s = bulge_sweep::run(&plan, a[2].as_ref(), &bulge_sweep::RunOptions { resume: true, csv: a.len()>3, ..Default::default() }, &|_| ()).map_err(|e| e.to_string()).unwrap(); println!("{s:?} {:?}", t.elapsed()); }
