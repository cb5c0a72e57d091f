//! Example 3. Which dimension of my muscle must be measured most carefully?
//!
//! The derivatives of force and volume with respect to every parameter are exact (dual numbers and the implicit function theorem), so an
//! error budget needs one solve. Expect the length to matter most (at the same contraction). Try next: another contraction; the same at 2 %.

use bulge::fibre::{Approach, Problem};
use bulge::muscles::{Fibre, Force, Parameter, Pressure, preset};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let muscle = preset("ppam-2-r16")?.with_fibre(Fibre::new(Force::kn(12.0))?)?;
    let problem = Problem::new(&muscle, Pressure::bar(3.0))?;
    let gradient = problem.gradient(0.10, Approach::Auto)?;
    println!("change of the force at 10 % for 1 % more of");
    let mut largest = ("", 0.0);
    for parameter in Parameter::ALL {
        let Some(([by_force, _], value)) = gradient.by(&muscle, parameter).zip(muscle.get(parameter)) else {
            continue;
        };
        let change = 0.01 * value * by_force;
        println!("  {:<16} {change:+.2} N", parameter.name());
        if change.abs() > f64::abs(largest.1) {
            largest = (parameter.name(), change);
        }
    }
    println!("  contraction      {:+.2} N", 0.01 * 0.10 * gradient.by_contraction[0]);
    assert_eq!(largest.0, "length");
    Ok(())
}
