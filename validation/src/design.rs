//! Applications of muscles: sizes against S4, closed muscles against the stiffness of the equilibrium, a
//! filling against its closed form.

use bulge_design::gas::{Chamber, ClosedMuscle, Filling, GasModel, Load, Orifice, Supply};
use bulge_design::size::{LoadCase, Requirements, fluidic_muscles, size};
use bulge_fibre::{Approach, Given};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Pressure, preset};

use crate::check::{Check, Claim};

/// Loads in kg, pressures in bar and contractions in % that S4 reads from its figure 4.
const S4: [[f64; 3]; 8] = [
    [50.0, 4.5, 14.5],
    [50.0, 4.0, 12.5],
    [30.0, 4.0, 17.5],
    [70.0, 4.0, 7.5],
    [50.0, 3.0, 6.5],
    [50.0, 5.0, 16.5],
    [30.0, 3.0, 12.5],
    [70.0, 5.0, 12.5],
];

/// S4's worked examples.
pub(crate) fn sizes() -> Check {
    Claim {
        group: "design",
        name: "sizes of S4: contraction [%] at which a DMSP-20 holds 30 to 70 kg at 3 to 5 bar",
        source: "S4, read off a figure",
        tolerance: 0.5,
        why: "S4 reads to half a per cent, and takes 10 N for a kilogram",
    }
    .run(|tally| {
        let families = fluidic_muscles()?;
        for [kilograms, bar, percent] in S4 {
            let load = LoadCase::lift(0.05, 0.0, 10.0 * kilograms)?;
            let wish = Requirements {
                pressures_pa: vec![1e5 * bar],
                lengths_m: vec![],
                margin: 0.0,
                step_m: 0.0,
                weights: None,
            };
            let found = size(&families[1..2], &load, &wish)?;
            let contraction = found.choices.first().map_or(f64::NAN, |choice| choice.contraction[1]);
            tally.absolute(100.0 * contraction, percent, || format!("{kilograms} kg at {bar} bar"));
        }
        Ok(())
    })
}

/// Slopes of the force of the closed muscle against the stiffness of the equilibrium.
pub(crate) fn closed() -> Check {
    Claim {
        group: "design",
        name: "closed muscles, isothermal and adiabatic: slope of the force against the equilibrium's stiffness",
        source: "differences of fourth order of equilibria with the same gas",
        tolerance: 1e-7,
        why: "the differences' own error",
    }
    .run(|tally| {
        for (name, contraction) in [("ppam-2-r16", 0.2), ("dmsp-20-250", 0.12)] {
            let muscle = MuscleWithEffects::new(&preset(name)?, &[])?;
            for exponent in [1.0, 1.4] {
                let closed = ClosedMuscle::new(&muscle, 2e5, contraction, exponent)?;
                let h = 1e-3;
                let force = |k: f64| Ok::<_, crate::check::Trouble>(closed.at_contraction(contraction + k * h)?.force_n);
                let by = (8.0 * (force(1.0)? - force(-1.0)?) - (force(2.0)? - force(-2.0)?)) / (12.0 * h);
                let given = Given::Contraction(contraction);
                let there = muscle.solve(Pressure::bar(2.0), given, Approach::Auto)?;
                let slow = exponent < 1.2;
                let stiffness = if slow { there.stiffness_isothermal_n_per_m } else { there.stiffness_adiabatic_n_per_m };
                let length = there.length_m / (1.0 - contraction);
                tally.relative(-by / length, stiffness, || format!("{name}, exponent {exponent}"));
            }
        }
        Ok(())
    })
}

/// A vessel filled through a valve: the pressure first rises linearly, then as an arcsine.
pub(crate) fn filling() -> Check {
    Claim {
        group: "design",
        name: "a rigid vessel filled isothermally through a valve (ISO 6358): time to 90 %",
        source: "closed form: a line while choked, then an arcsine",
        tolerance: 1e-8,
        why: "adaptive steps of eighth order",
    }
    .run(|tally| {
        for (conductance, b, supply) in [(2e-8, 0.3, 6e5), (5e-9, 0.5, 3e5), (1e-8, 0.2, 0.5e5)] {
            let filling = Filling {
                chamber: Chamber::vessel(1e-3)?,
                orifice: Orifice::new(conductance, b)?,
                supply: Supply::Constant { pressure_pa: supply, temperature_k: 293.15 },
                gas: GasModel::Isothermal,
                start_pressure_pa: 0.0,
                start_temperature_k: 293.15,
                longest_s: 1e3,
                samples: 20,
            };
            let found = filling.run()?.time_90_s.unwrap_or(f64::NAN);
            // dP/dt = R T C P1 rho0 psi/V, psi = 1 to b P1, then sqrt(1 - ((P/P1 - b)/(1 - b))^2).
            let (ambient, top) = (101_325.0, supply + 101_325.0);
            let rate = 287.05 * 293.15 * conductance * top * 1.185 / 1e-3;
            let (start, choked, end) = (ambient, (b * top).max(ambient), ambient + 0.9 * supply);
            let angle = |p: f64| ((p / top - b) / (1.0 - b)).asin();
            let exact = (choked - start) / rate + top * (1.0 - b) * (angle(end) - angle(choked)) / rate;
            tally.relative(found, exact, || format!("b = {b}, {supply} Pa"));
        }
        Ok(())
    })
}

/// The force of a muscle that is filled while it is held.
pub(crate) fn held() -> Check {
    Claim {
        group: "design",
        name: "a muscle filled while held takes the air of P V/(R T)",
        source: "the gas law at both ends",
        tolerance: 1e-9,
        why: "the same equilibria at both ends",
    }
    .run(|tally| {
        let muscle = MuscleWithEffects::new(&preset("dmsp-20-250")?, &[])?;
        let filling = Filling {
            chamber: Chamber::muscle(&muscle, Load::Held(0.1))?.with_dead_volume(2e-5)?,
            orifice: Orifice::hole(2e-3)?,
            supply: Supply::Constant { pressure_pa: 5e5, temperature_k: 293.15 },
            gas: GasModel::Isothermal,
            start_pressure_pa: 0.0,
            start_temperature_k: 293.15,
            longest_s: 60.0,
            samples: 20,
        };
        let history = filling.run()?;
        let [first, last] = [history.samples.first(), history.samples.last()];
        let mass = |at: &bulge_design::gas::Sample| {
            (at.pressure_pa + 101_325.0) * (at.volume_m3 + 2e-5) / (287.05 * 293.15)
        };
        let taken = last.map_or(f64::NAN, mass) - first.map_or(f64::NAN, mass);
        tally.relative(history.air_kg, taken, || "air".into());
        Ok(())
    })
}
