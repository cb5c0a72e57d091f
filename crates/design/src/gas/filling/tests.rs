//! Fillings against closed forms, against conservation laws, and against quadratures that are independent of
//! the integration.

use super::*;
use crate::gas::examples::{braid, learnt, pleated, soft};
use crate::gas::{CP_AIR, CV_AIR, GAMMA, Load, R_AIR};
use bulge_model::MuscleWithEffects;
use bulge_muscles::Quantity as _;
use std::f64::consts::FRAC_PI_2;

const P0: f64 = 101_325.0;
const T0: f64 = 293.15;
const C: f64 = 2e-8;
const B: f64 = 0.3;
/// 1.185 kg/m^3 at 293.15 K.
const RHO: f64 = 1.185;

#[expect(clippy::large_types_passed_by_value, reason = "most are made in the call")]
fn filling(chamber: Chamber<'_>, gauge: f64) -> Filling<'_> {
    Filling {
        chamber,
        orifice: Orifice::new(C, B).unwrap(),
        supply: Supply::Constant { pressure_pa: gauge, temperature_k: T0 },
        gas: GasModel::Isothermal,
        start_pressure_pa: 0.0,
        start_temperature_k: T0,
        longest_s: 100.0,
        samples: 100,
    }
}

fn litre<'a>() -> Chamber<'a> {
    Chamber::vessel(1e-3).unwrap()
}

#[test]
fn a_rigid_vessel_fills_on_a_line_and_a_sine() {
    let found = filling(litre(), 6e5).run().unwrap();
    let supply = 6e5 + P0;
    // In units of the supply pressure per second.
    let rate = C * RHO * R_AIR * T0 / 1e-3;
    let choked = (B - P0 / supply) / rate;
    let ratio = |t: f64| {
        if t < choked {
            P0 / supply + rate * t
        } else {
            B + (1.0 - B) * (rate * (t - choked) / (1.0 - B)).sin()
        }
    };
    assert!(found.samples.len() > 100 && found.settled);
    for sample in &found.samples {
        let exact = supply * ratio(sample.time_s) - P0;
        assert!((sample.pressure_pa - exact).abs() < 1e-8 * supply, "{sample:?} {exact}");
        let gas = (sample.pressure_pa + P0) * 1e-3 / (R_AIR * T0);
        assert!((sample.mass_kg / gas - 1.0).abs() < 1e-10);
    }
    let (time, last) = (choked + FRAC_PI_2 * (1.0 - B) / rate, found.samples.last().unwrap());
    assert!((last.time_s / time - 1.0).abs() < 1e-8, "{} {time}", last.time_s);
    assert!((last.pressure_pa / 6e5 - 1.0).abs() < 1e-12 && last.flow_kg_per_s.abs() < 1e-18);
    // 90 % of the gauge pressure.
    for (part, found) in [(0.9, found.time_90_s), (0.99, found.time_99_s)] {
        let x = ((part * 6e5 + P0) / supply - B) / (1.0 - B);
        let exact = choked + x.asin() * (1.0 - B) / rate;
        assert!((found.unwrap() / exact - 1.0).abs() < 1e-8);
    }
    assert!((found.air_kg / (6e5 * 1e-3 / (R_AIR * T0)) - 1.0).abs() < 1e-10);
    assert!(found.energy.is_none());
}

#[test]
fn a_supply_too_weak_to_choke_fills_on_a_sine_alone() {
    let found = filling(litre(), 0.5e5).run().unwrap();
    let supply = 0.5e5 + P0;
    let (rate, start) = (C * RHO * R_AIR * T0 / 1e-3 / (1.0 - B), ((P0 / supply - B) / (1.0 - B)).asin());
    for sample in &found.samples {
        let angle = (start + rate * sample.time_s).min(FRAC_PI_2);
        let exact = supply * (B + (1.0 - B) * angle.sin()) - P0;
        assert!((sample.pressure_pa - exact).abs() < 1e-8 * supply);
    }
    let time = (FRAC_PI_2 - start) / rate;
    assert!((found.samples.last().unwrap().time_s / time - 1.0).abs() < 1e-8);
}

/// Subsonic venting to the ambient with r = p0/P: dt = -dP/(rate P w(p0/P)), by Simpson's rule in theta with
/// r = b + (1 - b) sin(theta).
#[test]
fn a_rigid_vessel_blows_down_exponentially() {
    let blow = Filling { supply: Supply::ambient(), start_pressure_pa: 6e5, ..filling(litre(), 0.0) };
    let found = blow.run().unwrap();
    let rate = C * RHO * R_AIR * T0 / 1e-3;
    let choked = ((6e5 + P0) * B / P0).ln() / rate;
    let mut seen = 0;
    for sample in found.samples.iter().filter(|sample| sample.time_s < choked) {
        let exact = (6e5 + P0) * (-rate * sample.time_s).exp();
        assert!(((sample.pressure_pa + P0) / exact - 1.0).abs() < 1e-8);
        assert!((sample.flow_kg_per_s / (-C * RHO * exact) - 1.0).abs() < 1e-8);
        seen += 1;
    }
    assert!(seen > 20);
    let n = 2000;
    let rest: f64 = (0..=n)
        .map(|i| {
            let theta = FRAC_PI_2 * f64::from(i) / f64::from(n);
            let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            weight * (1.0 - B) / (B + (1.0 - B) * theta.sin()) * FRAC_PI_2 / f64::from(3 * n)
        })
        .sum();
    let last = found.samples.last().unwrap();
    assert!(
        (last.time_s / (choked + rest / rate) - 1.0).abs() < 1e-8,
        "{} {}",
        last.time_s,
        choked + rest / rate
    );
    assert!(last.pressure_pa.abs() < 1e-6 && found.settled);
}

#[test]
fn an_evacuated_vessel_heats_to_gamma_times_the_supply() {
    let start = 10.0;
    let evacuated =
        Filling { gas: GasModel::adiabatic(), start_pressure_pa: start - P0, ..filling(litre(), 6e5) };
    let found = evacuated.run().unwrap();
    let last = found.samples.last().unwrap();
    // Energy balance: U2 - U1 = cp Ts (m2 - m1).
    let supply = 6e5 + P0;
    let came = (supply - start) * 1e-3 / (GAMMA * R_AIR * T0);
    let exact = supply * 1e-3 / (R_AIR * (came + start * 1e-3 / (R_AIR * T0)));
    assert!((last.temperature_k / exact - 1.0).abs() < 1e-9, "{} {exact}", last.temperature_k);
    assert!((last.temperature_k / (GAMMA * T0) - 1.0).abs() < 1e-5);
    // From the ambient the gas is a mixture and gets less hot.
    let full = Filling { start_pressure_pa: 0.0, ..evacuated }.run().unwrap();
    let came = 6e5 * 1e-3 / (GAMMA * R_AIR * T0);
    let exact = supply * 1e-3 / (R_AIR * (came + P0 * 1e-3 / (R_AIR * T0)));
    assert!((full.samples.last().unwrap().temperature_k / exact - 1.0).abs() < 1e-9);
    // At the same supply temperature, adiabatic filling is gamma times as fast as isothermal filling.
    let rate = GAMMA * C * RHO * R_AIR * T0 / 1e-3;
    let time = (B - P0 / supply + FRAC_PI_2 * (1.0 - B)) / rate;
    assert!((full.samples.last().unwrap().time_s / time - 1.0).abs() < 1e-8);
}

/// Emptying without heat: T varies like P^((gamma - 1)/gamma), and while choked dP/dt = -gamma R T m'/V.
#[test]
fn adiabatic_blow_down_is_isentropic() {
    let blow = Filling {
        supply: Supply::ambient(),
        gas: GasModel::adiabatic(),
        start_pressure_pa: 6e5,
        ..filling(litre(), 0.0)
    };
    let found = blow.run().unwrap();
    let rate = C * RHO * R_AIR * T0 / 1e-3;
    for sample in &found.samples {
        let ratio = (sample.pressure_pa + P0) / (6e5 + P0);
        let exact = T0 * ratio.powf((GAMMA - 1.0) / GAMMA);
        assert!((sample.temperature_k / exact - 1.0).abs() < 1e-9);
        if ratio > P0 / B / (6e5 + P0) {
            // P = P1 (1 + (gamma - 1)/2 rate t)^(-2 gamma/(gamma - 1)).
            let choked =
                (1.0 + 0.5 * (GAMMA - 1.0) * rate * sample.time_s).powf(-2.0 * GAMMA / (GAMMA - 1.0));
            assert!((ratio / choked - 1.0).abs() < 1e-8);
        }
    }
    let energy = found.energy.unwrap();
    assert!(energy.work_j.abs() < 1e-7 * energy.internal_j.abs(), "{energy:?}");
}

fn lifting(muscle: &MuscleWithEffects, load: f64) -> Filling<'_> {
    let chamber = Chamber::muscle(muscle, Load::Force(load)).unwrap().on_support(0.05).unwrap();
    filling(chamber.with_dead_volume(2e-5).unwrap(), 4e5)
}

/// The work of the gas from the energy balance equals the work on load and atmosphere.
#[test]
fn energy_is_conserved_while_a_load_goes_up() {
    for (muscle, load) in [(pleated(), 400.0), (braid(), 300.0)] {
        for heat in [0.0, 0.5] {
            let gas = GasModel::Adiabatic { heat_transfer_w_per_k: heat, wall_temperature_k: 290.0 };
            let found = Filling { gas, longest_s: 3.0, ..lifting(&muscle, load) }.run().unwrap();
            let [first, last] = [found.samples[0], *found.samples.last().unwrap()];
            let stroke = (last.contraction - first.contraction) * muscle.muscle().length().si();
            assert!(stroke > 5e-3 && (first.contraction - 0.05).abs() < 1e-15);
            let wanted = load * stroke + P0 * (last.volume_m3 - first.volume_m3);
            let energy = found.energy.unwrap();
            let error = energy.work_j / wanted - 1.0;
            assert!(error.abs() < 1e-7, "{heat}: {error:e} {energy:?}");
            // Internal energy from the samples, enthalpy from the mass of air.
            let internal = CV_AIR * (last.mass_kg * last.temperature_k - first.mass_kg * first.temperature_k);
            assert!((energy.internal_j / internal - 1.0).abs() < 1e-7);
            assert!((energy.enthalpy_j / (CP_AIR * T0 * found.air_kg) - 1.0).abs() < 1e-9);
            assert!(heat > 0.0 || energy.heat_j.abs() < 1e-15);
        }
    }
}

/// t = integral of dm/m'(p) with m = P (V(p) + Vd)/(R T): by midpoints, with equilibria alone.
#[test]
fn the_time_is_that_of_a_quadrature() {
    for (muscle, load) in [(pleated(), 400.0), (soft(), 300.0)] {
        let setup = lifting(&muscle, load);
        let found = setup.run().unwrap();
        let mass = |p: f64| (p + P0) * setup.chamber.at(p).unwrap().gas_volume_m3 / (R_AIR * T0);
        let n = 400;
        let at = |i: f64| 0.9 * 4e5 * i / f64::from(n);
        let (mut time, mut last) = (0.0, mass(0.0));
        for i in 0..n {
            let middle = at(f64::from(i) + 0.5) + P0;
            let next = mass(at(f64::from(i) + 1.0));
            time += (next - last) / setup.orifice.flow([4e5 + P0, T0], [middle, T0]).unwrap();
            last = next;
        }
        let t90 = found.time_90_s.unwrap();
        assert!((t90 / time - 1.0).abs() < 1e-4, "{t90} {time}");
        // More samples take more steps, but the times don't change.
        let fine = Filling { samples: 300, ..setup }.run().unwrap();
        let [a, b] = [&found, &fine].map(|found| found.samples.last().unwrap().time_s);
        assert!((a / b - 1.0).abs() < 1e-8 && (t90 / fine.time_90_s.unwrap() - 1.0).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn mass_is_what_flowed_and_the_load_is_carried() {
    let muscle = soft();
    let setup = lifting(&muscle, 300.0);
    let found = Filling { samples: 300, ..setup }.run().unwrap();
    // Hermite's rule between samples needs the slope of the flow; the trapezium is enough to see 1e-4.
    let flowed: f64 = found
        .samples
        .windows(2)
        .map(|pair| 0.5 * (pair[0].flow_kg_per_s + pair[1].flow_kg_per_s) * (pair[1].time_s - pair[0].time_s))
        .sum();
    assert!((flowed / found.air_kg - 1.0).abs() < 1e-4, "{flowed} {}", found.air_kg);
    let mut lifted = 0;
    for sample in &found.samples {
        let gas = (sample.pressure_pa + P0) * (sample.volume_m3 + 2e-5) / (R_AIR * T0);
        assert!((sample.mass_kg / gas - 1.0).abs() < 1e-9);
        assert!(sample.force_n < 300.0 * (1.0 + 1e-8) && sample.contraction > 0.05 - 1e-9);
        if sample.contraction > 0.05 + 1e-7 {
            assert!((sample.force_n / 300.0 - 1.0).abs() < 1e-7);
            lifted += 1;
        }
    }
    assert!(lifted > 50 && lifted < found.samples.len());
    // On the way down the load returns to its support, and the same mass of air flows out.
    let down = Filling { supply: Supply::ambient(), start_pressure_pa: 4e5, ..setup }.run().unwrap();
    let last = down.samples.last().unwrap();
    assert!((last.contraction - 0.05).abs() < 1e-12 && last.pressure_pa.abs() < 1e-6 && down.settled);
    assert!((down.air_kg / found.air_kg + 1.0).abs() < 1e-9);
    assert!(down.time_90_s.unwrap() < down.time_99_s.unwrap());
}

#[test]
fn a_held_inextensible_muscle_is_a_vessel() {
    let muscle = pleated();
    let held = Chamber::muscle(&muscle, Load::Held(0.15)).unwrap().with_dead_volume(3e-5).unwrap();
    let volume = held.at(1e5).unwrap().gas_volume_m3;
    let [one, other] = [filling(held, 3e5), filling(Chamber::vessel(volume).unwrap(), 3e5)]
        .map(|setup| Filling { gas: GasModel::adiabatic(), ..setup }.run().unwrap());
    assert_eq!(one.samples.len(), other.samples.len());
    assert!((one.time_99_s.unwrap() / other.time_99_s.unwrap() - 1.0).abs() < 1e-9);
    assert!((one.samples.last().unwrap().time_s / other.samples.last().unwrap().time_s - 1.0).abs() < 1e-9);
    for (a, b) in one.samples.iter().zip(&other.samples) {
        // Rounding leads to steps of another size.
        assert!((a.pressure_pa - b.pressure_pa).abs() < 0.1 && (a.time_s - b.time_s).abs() < 1e-7);
        let pull = held.at(1e5).unwrap().force_n * a.pressure_pa / 1e5;
        assert!((a.force_n - pull).abs() < 1e-6);
    }
    // This also holds below the least pressure that is solved.
    assert!((held.at(40.0).unwrap().force_n / held.at(4e5).unwrap().force_n - 1e-4).abs() < 1e-12);
    assert!(held.at(0.0).unwrap().force_n.abs() < 1e-12);
}

#[test]
fn springs_are_laws() {
    let muscle = learnt();
    let l0 = 0.25;
    let spring = Load::Spring { preload_n: 50.0, rate_n_per_m: 2e3, from: 0.02 };
    let law = |e: f64| 50.0 + 2e3 * l0 * (e - 0.02);
    let run = |load| {
        let chamber = Chamber::muscle(&muscle, load).unwrap().on_support(0.02).unwrap();
        Filling { samples: 10, ..filling(chamber, 2e5) }.run().unwrap()
    };
    let (one, other) = (run(spring), run(Load::Law(&law)));
    let [a, b] = [&one, &other].map(|found| *found.samples.last().unwrap());
    assert!((a.contraction - b.contraction).abs() < 1e-8 && a.contraction > 0.05);
    assert!((a.force_n / law(a.contraction) - 1.0).abs() < 1e-8, "{a:?}");
    assert!((a.time_s / b.time_s - 1.0).abs() < 1e-7);
    // A load that decreases with the contraction (a linkage) has a balance as well.
    let falling = |e: f64| 150.0 * (1.0 - 2.0 * e);
    let chamber = Chamber::muscle(&muscle, Load::Law(&falling)).unwrap();
    let found = chamber.at(2e5).unwrap();
    assert!((found.force_n / falling(found.contraction) - 1.0).abs() < 1e-8);
}

#[test]
fn a_vessel_shares_its_air() {
    let supply = Supply::Vessel { pressure_pa: 6e5, temperature_k: T0, volume_m3: 2e-3 };
    let found = Filling { supply, ..filling(litre(), 0.0) }.run().unwrap();
    let last = found.samples.last().unwrap();
    assert!((last.pressure_pa / 4e5 - 1.0).abs() < 1e-10, "{}", last.pressure_pa);
    assert!((found.air_kg / (4e5 * 1e-3 / (R_AIR * T0)) - 1.0).abs() < 1e-10);
    assert!(found.settled && found.final_pressure_pa.to_bits() == last.pressure_pa.to_bits());
    assert!(found.time_90_s.unwrap() < found.time_99_s.unwrap());
    // An infinitely large vessel is a constant supply.
    let endless = Supply::Vessel { pressure_pa: 6e5, temperature_k: T0, volume_m3: 1e6 };
    let [a, b] = [Filling { supply: endless, ..filling(litre(), 0.0) }, filling(litre(), 6e5)]
        .map(|setup| setup.run().unwrap().samples.last().unwrap().time_s);
    assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
    // The computed time is shorter than the filling takes.
    let cut = Filling { supply, longest_s: 0.01, ..filling(litre(), 0.0) }.run().unwrap();
    assert!(!cut.settled && cut.time_90_s.is_none());
    assert!((cut.samples.last().unwrap().time_s - 0.01).abs() < 1e-12);
}

#[test]
fn walls_take_the_heat_back() {
    let warm = |heat: f64, longest_s: f64| {
        let gas = GasModel::Adiabatic { heat_transfer_w_per_k: heat, wall_temperature_k: T0 };
        Filling { gas, longest_s, ..filling(litre(), 6e5) }.run().unwrap()
    };
    let found = warm(0.05, 5e3);
    let last = found.samples.last().unwrap();
    assert!(found.settled && (last.temperature_k / T0 - 1.0).abs() < 2e-6, "{last:?}");
    // The pressure stays within 5e-7 (1 - b) of the supply's, and the mass is that of the cold gas.
    assert!((last.pressure_pa / 6e5 - 1.0).abs() < 1e-6);
    let cold = (6e5 + P0) * 1e-3 / (R_AIR * T0);
    assert!((last.mass_kg / cold - 1.0).abs() < 3e-6);
    let hottest = found.samples.iter().map(|sample| sample.temperature_k).fold(0.0, f64::max);
    assert!(hottest > 1.1 * T0 && hottest < GAMMA * T0);
    let energy = found.energy.unwrap();
    assert!(energy.heat_j < 0.0 && energy.work_j.abs() < 1e-6 * energy.internal_j, "{energy:?}");
    // While the gas cools at constant pressure, V P = m R T gives dT/dt = -hA (T - Tw) T/(m T cp), so T - Tw
    // decays like exp(-t hA/(m cp)) for small differences.
    let late: Vec<_> = found
        .samples
        .iter()
        .filter(|s| s.time_s > 1.0 && (1e-3..0.3).contains(&(s.temperature_k - T0)))
        .collect();
    let [a, b] = [late[0], late[late.len() / 2]];
    let slope = ((a.temperature_k - T0) / (b.temperature_k - T0)).ln() / (b.time_s - a.time_s);
    assert!((slope / (0.05 / (cold * CP_AIR)) - 1.0).abs() < 2e-3, "{slope}");
    // Gas heated at constant pressure expands out of the vessel: dm/m = -dT/T, so Q = P V cp/R ln(Tw/T), all
    // of which leaves as enthalpy.
    let gas = GasModel::Adiabatic { heat_transfer_w_per_k: 0.05, wall_temperature_k: 400.0 };
    let hot = Filling { gas, longest_s: 1e4, start_pressure_pa: 6e5, ..filling(litre(), 6e5) }.run().unwrap();
    let energy = hot.energy.unwrap();
    let heat = (6e5 + P0) * 1e-3 * CP_AIR / R_AIR * (400.0 / T0).ln();
    assert!((energy.heat_j / heat - 1.0).abs() < 1e-5 && (energy.enthalpy_j / heat + 1.0).abs() < 1e-5);
    assert!(hot.settled && hot.air_kg < 0.0);
    // A large heat transfer is isothermal.
    let isothermal = filling(litre(), 6e5).run().unwrap();
    let fast = warm(1e4, 5e3);
    assert!((fast.time_90_s.unwrap() / isothermal.time_90_s.unwrap() - 1.0).abs() < 1e-3);
}

/// The flow controlled by the heat keeps the pressures equal, also from a vessel and with a moving muscle.
#[test]
fn a_vessel_and_a_muscle_end_as_warm_as_their_walls() {
    let muscle = pleated();
    let supply = Supply::Vessel { pressure_pa: 6e5, temperature_k: T0, volume_m3: 1e-3 };
    let gas = GasModel::Adiabatic { heat_transfer_w_per_k: 0.05, wall_temperature_k: T0 };
    let setup = Filling { supply, gas, longest_s: 1e4, ..lifting(&muscle, 400.0) };
    let found = setup.run().unwrap();
    assert!(found.settled);
    let last = found.samples.last().unwrap();
    let left = 6e5 + P0 - found.air_kg * R_AIR * T0 / 1e-3;
    assert!(((last.pressure_pa + P0) / left - 1.0).abs() < 1e-6, "{last:?} {left}");
    // The end is that of the isothermal filling: the same air, shared.
    let isothermal = Filling { gas: GasModel::Isothermal, ..setup }.run().unwrap();
    let end = isothermal.samples.last().unwrap();
    assert!((last.pressure_pa / end.pressure_pa - 1.0).abs() < 2e-6);
    assert!((last.contraction - end.contraction).abs() < 1e-6);
    // The pressure fell while the gas cooled, so the heat flow mattered.
    let least = found.samples.iter().map(|s| s.temperature_k).fold(0.0, f64::max);
    assert!(least > 1.02 * T0);
}

#[test]
fn the_path_is_that_of_equilibria() {
    let spring = Load::Spring { preload_n: 50.0, rate_n_per_m: 2e3, from: 0.02 };
    for (muscle, load) in [(soft(), Load::Force(300.0)), (learnt(), spring), (braid(), Load::Held(0.1))] {
        let chamber = Chamber::muscle(&muscle, load).unwrap().with_dead_volume(1e-5).unwrap();
        let path = path::Path::new(&chamber, 4e5);
        for p in [1.1e5, 1.737e5, 2.9e5, 3.999e5] {
            let (found, exact) = (path.inside(p, false).unwrap(), chamber.at(p).unwrap());
            assert!((found.contraction - exact.contraction).abs() < 1e-9);
            assert!((found.force_n / exact.force_n - 1.0).abs() < 1e-8);
            assert!((found.gas_volume_m3 / exact.gas_volume_m3 - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn what_cannot_be_is_said() {
    let good = filling(litre(), 6e5);
    let heat = |heat_transfer_w_per_k, wall_temperature_k| GasModel::Adiabatic {
        heat_transfer_w_per_k,
        wall_temperature_k,
    };
    for bad in [
        Filling { start_pressure_pa: -P0, ..good },
        Filling { start_pressure_pa: f64::NAN, ..good },
        Filling { start_temperature_k: 0.0, ..good },
        Filling { longest_s: 0.0, ..good },
        Filling { longest_s: f64::INFINITY, ..good },
        Filling { samples: 1, ..good },
        Filling { gas: heat(-1.0, T0), ..good },
        Filling { gas: heat(1.0, f64::NAN), ..good },
        Filling { supply: Supply::Constant { pressure_pa: f64::NAN, temperature_k: T0 }, ..good },
        Filling { supply: Supply::Constant { pressure_pa: 1e5, temperature_k: -1.0 }, ..good },
        Filling { supply: Supply::Vessel { pressure_pa: 1e5, temperature_k: T0, volume_m3: 0.0 }, ..good },
    ] {
        assert!(matches!(bad.run(), Err(GasError::Number { .. })), "{bad:?}");
    }
    assert!(Chamber::vessel(0.0).is_err() && litre().with_dead_volume(f64::NAN).is_err());
    assert!(litre().with_ambient(-1.0).is_err() && litre().on_support(1.0).is_err());
    let muscle = braid();
    assert!(Chamber::muscle(&muscle, Load::Force(f64::NAN)).is_err());
    // A muscle can't hold a vacuum.
    let held = Chamber::muscle(&muscle, Load::Held(0.1)).unwrap();
    assert!(matches!(
        Filling { start_pressure_pa: -10.0, ..filling(held, 1e5) }.run(),
        Err(GasError::Number { .. })
    ));
    // Nothing to do.
    let equal = Filling { start_pressure_pa: 6e5, ..good }.run().unwrap();
    assert!(equal.settled && equal.air_kg.abs() < 1e-18);
    assert_eq!((equal.time_90_s, equal.samples.len()), (Some(0.0), 1));
    // A load without support that exceeds what the muscle can carry as the pressure falls, so that its fibres
    // are drawn straight.
    let hung = Chamber::muscle(&muscle, Load::Force(300.0)).unwrap();
    // F = p pi r0^2 2/sin^2(alpha0) with straight fibres.
    let straight = 300.0 * 25_f64.to_radians().sin().powi(2) / (2e-4 * std::f64::consts::PI);
    // The result doesn't depend on the positions of the steps.
    for conductance in [C, 1.01 * C, 0.37 * C] {
        let orifice = Orifice::new(conductance, B).unwrap();
        let vented =
            Filling { supply: Supply::ambient(), start_pressure_pa: 4e5, orifice, ..filling(hung, 0.0) };
        let error = vented.run().unwrap_err();
        let GasError::Stopped { time_s, pressure_pa, reason } = error else { panic!("{error}") };
        assert!(time_s > 0.0 && (pressure_pa / straight - 1.0).abs() < 3e-3, "{pressure_pa} {straight}");
        assert!(!reason.is_empty());
    }
}
