//! Equilibria of random muscles: the length, the volume and the force of an equilibrium each lead back to one
//! that has them, and its derivatives agree with each other. A search that goes by too large steps misses
//! these.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_muscles::{
    Angle, Braided, Construction, FibreCount, Length, Muscle,
    Parameter::{
        self, C10, ClothCircumference, FibreStiffness, Fibres, FittingRadius, GasWall, HoopStiffness,
        UnfoldedRadius, Wall,
    },
    Pleated, Pressure,
};

/// A braid of 60 fibres: length and radius in m, radians.
fn braid([length, radius, angle]: [f64; 3], more: &[(Parameter, f64)]) -> Muscle {
    let braid = Braided::new(Length::m(radius), Angle::rad(angle)).unwrap().with_fibres(60).unwrap();
    let muscle = Muscle::new("braid", Length::m(length), Construction::Braided(braid)).unwrap();
    muscle.with_all(more).unwrap()
}

/// A pleated muscle: length and radius in m.
fn pleated([length, radius]: [f64; 2], more: &[(Parameter, f64)]) -> Muscle {
    let pleated = Pleated::new(Length::m(radius), FibreCount::Discrete(3)).unwrap();
    let muscle = Muscle::new("pleated", Length::m(length), Construction::Pleated(pleated)).unwrap();
    muscle.with_all(more).unwrap()
}

/// The equilibrium at `given` and those with its length, its volume and its force, which are the same force
/// and volume again.
fn leads_back(muscle: &Muscle, bar: f64, given: Given) -> Response {
    let problem = Problem::new(muscle, Pressure::bar(bar)).unwrap();
    let found = problem.solve(given, Approach::Auto).unwrap();
    let scale = found.pressure_pa * found.max_radius_m.powi(2) + found.force_n.abs();
    for given in [Given::Length(found.length_m), Given::Volume(found.volume_m3), Given::Force(found.force_n)]
    {
        let again = problem.solve(given, Approach::Auto);
        let again = again.map_err(|error| format!("{given:?} at {}: {error}", found.contraction)).unwrap();
        let off = match given {
            Given::Volume(volume) => again.volume_m3 / volume - 1.0,
            _ => (again.force_n - found.force_n) / scale,
        };
        assert!(off.abs() < 1e-6, "{given:?} at {}: {off:e}", found.contraction);
    }
    found
}

/// Braids of a stiff bladder on fittings of another radius. The first holds most in the middle of its range,
/// the second more and more the farther it is drawn out: a volume that is larger than at the end of the range
/// is found on the way.
#[test]
fn a_volume_larger_than_at_the_end_is_found() {
    let narrow = braid(
        [0.053_774_704_386_715_125, 0.018_970_132_095_800_93, 0.346_823_749_991_548_75],
        &[
            (FittingRadius, 0.003_952_394_618_491_908),
            (Wall, 0.001_647_898_334_945_759_1),
            (C10, 148_915_364.104_481_8),
            (GasWall, 0.000_133_187_362_508_406_24),
            (HoopStiffness, 747_420.703_921_087_8),
            (UnfoldedRadius, 0.003_963_837_196_193_597),
        ],
    );
    leads_back(&narrow, 8.223_094_664_112_336, Given::Contraction(0.172_607_854_188_059_16));
    let wide = braid(
        [0.016_993_690_076_248_91, 0.009_585_326_733_984_047, 0.464_712_570_385_541_3],
        &[
            (FittingRadius, 0.015_660_740_374_795_65),
            (Wall, 0.000_514_768_108_990_712_5),
            (C10, 4_761_964.477_774_058),
            (Parameter::C01, 518_207.878_375_872_97),
        ],
    );
    let bar = 0.150_295_944_926_955_47;
    let found = leads_back(&wide, bar, Given::Contraction(0.455_288_854_217_880_4));
    // What is refused is more than any of these.
    let problem = Problem::new(&wide, Pressure::bar(bar)).unwrap();
    let error = problem.solve(Given::Volume(10.0 * found.volume_m3), Approach::Auto).unwrap_err();
    let FibreError::VolumeTooLarge { high_m3, .. } = error else { panic!("{error}") };
    assert!(high_m3 > found.volume_m3, "{error}");
}

/// A long braid of elastic fibres holds least where it is drawn out. A pleated one with lobes holds most where
/// its fibres are stretched as far as any bears.
#[test]
fn a_volume_next_to_the_least_or_the_largest_is_found() {
    let long = braid(
        [0.538_775_628_434_139, 0.005_658_194_697_841_763, 0.424_322_410_945_907_47],
        &[(FibreStiffness, 50_843.397_321_909_455)],
    );
    leads_back(&long, 3.901_489_300_906_156, Given::Force(5_338.113_594_170_798));
    let stretched = pleated(
        [0.047_145_920_682_955_95, 0.033_317_626_734_006_75],
        &[
            (Fibres, 24.0),
            (FibreStiffness, 32.885_322_105_653_43),
            (ClothCircumference, 0.234_412_122_126_406_16),
        ],
    );
    leads_back(&stretched, 0.215_518_096_902_869_73, Given::Force(15.475_523_084_170_968));
}

/// Gas far inside a braid makes the force largest in the middle of the range.
#[test]
fn a_force_next_to_the_largest_is_found() {
    let muscle = braid(
        [0.487_021_794_594_274_7, 0.012_400_276_782_776_443, 0.175_721_677_669_230_72],
        &[(GasWall, 0.003_543_072_345_896_780_4)],
    );
    let bar = 0.853_605_316_779_694;
    let found = leads_back(&muscle, bar, Given::Volume(0.000_192_117_896_128_900_12));
    let problem = Problem::new(&muscle, Pressure::bar(bar)).unwrap();
    let error = problem.solve(Given::Force(1.1 * found.force_n), Approach::Auto).unwrap_err();
    let FibreError::ForceTooLarge { high_n, contraction, .. } = error else { panic!("{error}") };
    assert!(high_n > found.force_n, "{error}");
    // The force doesn't change there.
    let most = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap();
    assert!(most.stiffness_n_per_m.abs() * most.length_m < 1e-3 * high_n, "{most:?}");
}

/// Braids that are drawn out until their waist is as narrow as their fibres make it: with stiff cloth, and on
/// narrow fittings, where rounding hid how far that is.
#[test]
fn a_length_of_a_drawn_out_braid_is_found() {
    let cloth = braid(
        [0.299_584_577_147_761_4, 0.007_711_931_730_356_654_5, 0.834_913_968_588_369],
        &[(HoopStiffness, 8_678.983_838_291_124), (UnfoldedRadius, 0.007_734_414_977_102_364)],
    );
    leads_back(&cloth, 0.029_350_586_899_771_52, Given::Force(12.075_808_328_701_715));
    let narrow = braid(
        [0.664_553_003_141_529_4, 0.025_059_670_218_581_145, 0.655_665_916_678_950_7],
        &[(FittingRadius, 0.008_087_950_221_019_475)],
    );
    let found = leads_back(&narrow, 6.693_410_091_322_629, Given::Force(13_959.453_913_065_829));
    let problem = Problem::new(&narrow, Pressure::bar(6.7)).unwrap();
    let longest = problem.longest().unwrap();
    assert!(longest < found.contraction && longest > -0.3, "{longest}");
}

/// 278 lobes, next to which the errors of an integration add up; and a muscle whose middle differs from a
/// cylinder by exp(-50 000), where rounding is relative to that.
#[test]
fn rounding_of_long_cylinders_and_many_lobes_is_no_obstacle() {
    let lobes = pleated(
        [0.092_160_615_457_527_17, 0.013_952_558_303_059_13],
        &[(Fibres, 278.0), (ClothCircumference, 0.298_218_624_394_547_66)],
    );
    leads_back(&lobes, 6.998_947_837_424_424, Given::Force(423.642_901_513_373_43));
    let long = pleated(
        [2.740_205_683_660_049_5, 0.015_921_765_716_524_663],
        &[(HoopStiffness, 13_080_286.576_703_446), (UnfoldedRadius, 0.032_950_922_247_338_98)],
    );
    leads_back(&long, 0.012_825_299_583_489_67, Given::Force(8.210_441_263_374_102));
}

/// dF/dp = -dV/dl where fibres carry 10^5 times what the pressure needs: dF/dp is the small difference of two
/// large numbers.
#[test]
fn derivatives_by_the_pressure_are_exact_in_stretched_fibres() {
    let muscle = braid(
        [0.010_486_254_758_717_003, 0.004_577_562_115_860_28, 0.524_103_095_667_946_2],
        &[(FibreStiffness, 430_172.536_445_925_4)],
    );
    let problem = Problem::new(&muscle, Pressure::pa(144_965.268_557_139_38)).unwrap();
    let gradient = problem.gradient(-0.047_736_551_422_043_85, Approach::Auto).unwrap();
    let by_length = -gradient.by_contraction[1] / muscle.get(Parameter::Length).unwrap();
    let off = gradient.by_pressure[0] / by_length + 1.0;
    assert!(off.abs() < 1e-6, "{off:e}: {gradient:?}");
}
