//! Example 1. How strongly does a pleated muscle pull, and at which contraction does it pull with 500 N?
//!
//! One equation: `cos(psi) N = F + p A(r)` along the meridian; for straight fibres it has a closed form (elliptic integrals).
//! Expect 544.0 N at 20 %, and 500 N at 21.3 %. Try next: another radius, fibres that stretch, a negative contraction.

use bulge::fibre::{Approach, Given, Problem};
use bulge::muscles::{Pressure, from_toml};

const MUSCLE: &str = r#"
name = "second-generation PPAM"
kind = "pleated"
length = "110 mm"
radius = "16 mm"
fibres = 40
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1. A muscle is a value that is always valid.
    let muscle = from_toml(MUSCLE, "example")?;
    // 2. With a pressure it is a problem,
    let problem = Problem::new(&muscle, Pressure::bar(1.0))?;
    // 3. which can be asked for a contraction, a length, a force or a volume.
    let at_20 = problem.solve(Given::Contraction(0.20), Approach::Auto)?;
    println!("at 20 % it pulls {:.1} N and holds {:.1} ml", at_20.force_n, 1e6 * at_20.volume_m3);
    assert!((at_20.force_n - 544.0).abs() < 0.1);
    let at_500 = problem.solve(Given::Force(500.0), Approach::Auto)?;
    println!("it pulls 500 N at {:.2} %", 100.0 * at_500.contraction);
    assert!((at_500.contraction - 0.2128).abs() < 1e-3);
    // 4. What doesn't exist is an error with the limit in it.
    if let Err(error) = problem.solve(Given::Contraction(0.45), Approach::Auto) {
        println!("{error}");
    }
    Ok(())
}
