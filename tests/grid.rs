//! Where vertices may lie: the cube, steps of each axis, lattices that several streams share.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::{build, grid, map_positions, noisy, sphere};
use lwc::{
    DecodeOptions, Decoder, EncodeError, EncodeOptions, Encoded, GridChoice, Lattice, Limits, Remedy,
    TriMesh, decode, encode,
};

fn with(change: impl Fn(&mut EncodeOptions)) -> EncodeOptions {
    let mut options = EncodeOptions::default();
    change(&mut options);
    options
}

fn on(lattice: Lattice) -> EncodeOptions {
    with(|options| options.grid = GridChoice::Lattice(lattice))
}

fn all(encoded: &Encoded) -> TriMesh {
    decode(&encoded.bytes, DecodeOptions::new()).unwrap()
}

/// Hills on [0, 10] × [0, 10], moved by a multiple of 10.
fn tile(column: f64) -> TriMesh {
    let hills = |x: f64, y: f64| 3.0 * (0.31 * x).sin() * (0.47 * y).cos() + 100.0;
    let place = |p: [f64; 3]| {
        let (x, y) = (p[0] + 5.0 + 10.0 * column, p[1] + 5.0);
        [x, y, hills(x, y)]
    };
    map_positions(grid(41, 41, |_, _| 0.0), |p| place([p[0] / 4.0, p[1] / 4.0, 0.0]))
}

/// Positions as bits, of vertices with that x, sorted.
fn border(mesh: &TriMesh, x: f64, tolerance: f64) -> Vec<[u64; 3]> {
    let near = mesh.positions().iter().filter(|p| (p[0] - x).abs() <= tolerance);
    let mut border: Vec<[u64; 3]> = near.map(|p| p.map(f64::to_bits)).collect();
    border.sort_unstable();
    border
}

#[test]
fn tiles_on_one_lattice_share_their_border_bit_for_bit() {
    let own = |column| all(&encode(&tile(column), &EncodeOptions::default()).unwrap());
    assert_ne!(border(&own(0.0), 10.0, 1e-9), border(&own(1.0), 10.0, 1e-9), "no need for a lattice");
    for lattice in [
        Lattice { origin: [0.0; 3], step: [0.003; 3] },
        Lattice { origin: [1e6 / 3.0, -1e5, 0.1], step: [0.003, 0.007, 0.01] },
        Lattice { origin: [3.0, 3.0, 300.0], step: [0.05, 0.01, 1.0 / 3.0] },
    ] {
        let [left, right] = [0.0, 1.0].map(|column| all(&encode(&tile(column), &on(lattice)).unwrap()));
        let tolerance = lattice.step[0];
        let shared = border(&left, 10.0, tolerance);
        assert_eq!(shared.len(), 41, "{lattice:?}");
        assert_eq!(shared, border(&right, 10.0, tolerance), "{lattice:?}");
    }
}

#[test]
fn a_stream_says_its_lattice_and_neighbours_can_use_it() {
    let lattice = Lattice { origin: [5.0, -3.0, 0.25], step: [0.01, 0.02, 0.5] };
    let left = encode(&tile(-7.0), &on(lattice)).unwrap();
    assert_eq!(left.info.lattice(), Some(lattice));
    assert_eq!(left.info.step(), lattice.step);
    assert!(left.info.lattice_offset()[0] < -7000 && left.info.lattice_offset()[2] > 100);
    let origin = left.info.origin();
    let expected = left.info.lattice_offset().map(|k| k as f64);
    assert_eq!(origin, [0, 1, 2].map(|a| lattice.origin[a] + expected[a] * lattice.step[a]));
    let cubic = encode(&tile(0.0), &EncodeOptions::default()).unwrap();
    assert_eq!((cubic.info.lattice(), cubic.info.lattice_offset()), (None, [0; 3]));
}

#[test]
fn no_coordinate_is_off_by_more_than_half_a_step() {
    let mesh = noisy(tile(0.3), 4, 0.05);
    for step in [[0.002; 3], [0.5, 0.01, 0.003], [7.0, 0.1, 50.0]] {
        let options = with(|o| (o.grid, o.keep_order) = (GridChoice::step(step), true));
        let encoded = encode(&mesh, &options).unwrap();
        let decoded = all(&encoded);
        let (mut largest, mut most) = ([0.0_f64; 3], 0.0_f64);
        for (p, q) in mesh.positions().iter().zip(decoded.positions()) {
            let off = [0, 1, 2].map(|a| (p[a] - q[a]).abs());
            largest = [0, 1, 2].map(|a| largest[a].max(off[a]));
            most = most.max(off.map(|x| x * x).iter().sum::<f64>().sqrt());
        }
        for axis in 0..3 {
            assert!(largest[axis] <= 0.5 * step[axis] * (1.0 + 1e-12), "{largest:?} on {step:?}");
        }
        assert!((encoded.grid_error.largest_error - most).abs() <= 1e-9 * most);
        assert_eq!(encoded.grid_error.step, step);
    }
}

#[test]
fn all_levels_of_a_lattice_lie_where_the_mesh_is() {
    let mesh = map_positions(noisy(sphere(3), 2, 0.02), |p| [1000.0 * p[0], p[1], 0.01 * p[2]]);
    let encoded = encode(&mesh, &with(|o| o.grid = GridChoice::step([0.1, 1e-4, 1e-6]))).unwrap();
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(&encoded.bytes).unwrap();
    let mut passes = 0;
    while decoder.step().unwrap().is_some() {
        let level = decoder.mesh().unwrap();
        let coarse = f64::from(1 << (encoded.info.quantization_bits() - level.quantization_bits()));
        for position in level.positions() {
            for (axis, size) in [1100.0, 1.1, 0.011].into_iter().enumerate() {
                let most = size + coarse * encoded.info.step()[axis];
                assert!(position[axis].abs() <= 1.2 * most, "{position:?}");
            }
        }
        passes += 1;
    }
    assert!(passes > 3);
}

#[test]
fn a_lattice_may_come_with_every_bit() {
    let mesh = noisy(tile(0.7), 9, 0.01);
    let options = with(|o| {
        (o.lossless, o.keep_order) = (true, true);
        o.grid = GridChoice::Lattice(Lattice { origin: [0.1, 1e7, -3.0], step: [0.03, 0.5, 11.0] });
    });
    let encoded = encode(&mesh, &options).unwrap();
    assert_eq!(all(&encoded), mesh);
    let error = encoded.grid_error;
    assert_eq!((error.largest_error, error.triangles_lost(), error.step), (0.0, 0, [0.03, 0.5, 11.0]));
}

#[test]
fn a_decoded_mesh_gives_the_same_bytes() {
    let rail = rail();
    let lattice = Lattice { origin: [0.1, -4.0, 2.0], step: [0.01, 0.03, 0.002] };
    for (mesh, options) in [(&tile(2.0), on(lattice)), (&rail, EncodeOptions::default())] {
        let once = encode(mesh, &options).unwrap();
        let again = encode(&all(&once), &options).unwrap();
        assert!(once.bytes == again.bytes);
        assert!(once.info.lattice().is_some());
    }
}

/// A bar of 1000 m with a section of 7 × 14 cm.
fn rail() -> TriMesh {
    let section = [[0.0, 0.0], [0.07, 0.0], [0.07, 0.05], [0.05, 0.14], [0.0, 0.14]];
    let n = section.len() as u32;
    let slices = 0..=40;
    let positions = slices.flat_map(|i| section.map(|[y, z]| [25.0 * f64::from(i), y, z])).collect();
    let side = |i: u32, k: u32| {
        let [a, b] = [n * i + k, n * i + (k + 1) % n];
        [[a, a + n, b], [b, a + n, b + n]]
    };
    build(positions, (0..40).flat_map(|i| (0..n).flat_map(move |k| side(i, k))).collect())
}

#[test]
fn axes_get_their_own_steps_only_where_a_cube_would_lose_triangles() {
    let encoded = encode(&rail(), &EncodeOptions::default()).unwrap();
    let [x, y, z] = encoded.info.step();
    assert!((x - 1000.0 / 4095.0).abs() < 1e-9 && (y - 0.07 / 4095.0).abs() < 1e-9, "{x} {y} {z}");
    assert!((z - 0.14 / 4095.0).abs() < 1e-9 && !encoded.grid_error.is_too_coarse());
    assert_eq!(encoded.info.quantization_bits(), 12);
    for options in [with(|o| o.grid = GridChoice::Cube), with(|o| o.lossless = true)] {
        assert_eq!(encode(&rail(), &options).unwrap().info.lattice(), None);
    }
    assert_eq!(encode(&tile(0.0), &EncodeOptions::default()).unwrap().info.lattice(), None);
}

#[test]
fn what_a_cube_would_lose_is_counted_with_what_would_do() {
    let cube = with(|o| o.grid = GridChoice::Cube);
    let error = encode(&rail(), &cube).unwrap().grid_error;
    assert!(error.is_too_coarse() && error.triangles_collapsed > 100, "{error:?}");
    assert_eq!(error.num_triangles, 400);
    assert!(error.largest_error_in_edges > 0.004 && error.largest_error_in_edges < 2.0, "{error:?}");
    let Some(Remedy::Bits(bits)) = error.remedy else { panic!("{error:?}") };
    let on_bits = |bits| with(|o| (o.grid, o.quantization_bits) = (GridChoice::Cube, bits));
    assert!(!encode(&rail(), &on_bits(bits)).unwrap().grid_error.is_too_coarse());
    assert!(encode(&rail(), &on_bits(bits - 1)).unwrap().grid_error.is_too_coarse());

    let coarse = with(|o| o.grid = GridChoice::step([1.0; 3]));
    let Some(Remedy::Step(step)) = encode(&rail(), &coarse).unwrap().grid_error.remedy else {
        panic!("a step is too coarse")
    };
    let fine = with(|o| o.grid = GridChoice::step(step));
    assert!(!encode(&rail(), &fine).unwrap().grid_error.is_too_coarse());
}

#[test]
fn what_is_no_grid_is_refused() {
    let refused = |lattice| encode(&tile(0.0), &on(lattice)).unwrap_err();
    for (origin, step) in [
        ([0.0; 3], [0.1, 0.0, 0.1]),
        ([0.0; 3], [0.1, -0.1, 0.1]),
        ([0.0; 3], [0.1, f64::NAN, 0.1]),
        ([f64::INFINITY, 0.0, 0.0], [0.1; 3]),
    ] {
        let error = refused(Lattice { origin, step });
        assert!(matches!(error, EncodeError::Option { option: "grid", .. }), "{error}");
    }
    for (origin, step) in [([0.0; 3], [1e-9, 1.0, 1.0]), ([1e300, 0.0, 0.0], [1.0; 3])] {
        let error = refused(Lattice { origin, step });
        let EncodeError::StepTooSmall { axis: 'x', smallest, .. } = error else { panic!("{error}") };
        let encoded = encode(&tile(0.0), &on(Lattice { origin, step: [smallest, 1.0, 1.0] }));
        assert!(encoded.is_ok(), "{smallest}: {encoded:?}");
    }
}

#[test]
fn places_far_out_and_sizes_of_all_kinds_go_through() {
    for (scale, shift) in [(1e-200, 0.0), (1e150, 0.0), (1.0, 1e12), (1e-9, 1.0)] {
        let mesh = map_positions(tile(0.0), |p| p.map(|x| x * scale + shift));
        let step = [1e-3 * scale, 1e-2 * scale, 1e-3 * scale];
        let encoded = encode(&mesh, &with(|o| o.grid = GridChoice::step(step))).unwrap();
        let decoded = all(&encoded);
        assert_eq!(decoded.num_triangles(), mesh.num_triangles());
        let ulp = shift * f64::EPSILON;
        assert!(encoded.grid_error.largest_error <= 6e-3 * scale + ulp, "{:?}", encoded.grid_error);
    }
}
