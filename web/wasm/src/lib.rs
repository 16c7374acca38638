//! The decoder as a handful of functions that take and return numbers.
//!
//! `web/src/decoder.ts` is the only caller. Decoders are named by numbers, not by pointers, so a wrong
//! handle is a trap and never a stray access. A trap, after which nothing of its call runs,
//! takes its decoder and leaves the others as they were. The one thing left to the caller is to write at most as
//! many bytes as it asked [`input`] for. There is no `unsafe` block; the attribute that exports a name
//! needs the word because two crates could export the same one, and nothing else is linked here.

#[cfg(feature = "assets")]
mod assets;
#[cfg(feature = "assets")]
mod drawing;
mod shading;
mod slot;

use slot::Slot;
use std::cell::{RefCell, RefMut};

/// A place for a decoder, which is used again when it is free. One whose decoder trapped stays borrowed for ever.
type Place = RefCell<Option<Slot>>;

thread_local! {
    // A WebAssembly instance has one thread.
    static PLACES: RefCell<Vec<&'static Place>> = const { RefCell::new(Vec::new()) };
}

fn with<R>(handle: u32, then: impl FnOnce(&mut Slot) -> R) -> R {
    then(&mut slot(handle))
}

#[inline(never)]
fn slot(handle: u32) -> RefMut<'static, Slot> {
    // The list is not borrowed any more when this or what follows traps.
    let place = PLACES.with_borrow(|places| places.get(handle as usize).copied());
    let slot = place.and_then(|place| RefMut::filter_map(place.try_borrow_mut().ok()?, Option::as_mut).ok());
    slot.expect("no such decoder")
}

/// Makes a decoder. `level`: the last level wanted, `u32::MAX` for all. Positions are given relative to
/// the smallest corner of the grid if `relative` is not 0; normals and the expected error are computed
/// if `shade` is not 0. `max_work` is not a number for the default.
#[unsafe(no_mangle)]
pub extern "C" fn create(
    level: u32,
    max_memory: f64,
    max_vertices: u32,
    max_work: f64,
    relative: u32,
    shade: u32,
) -> u32 {
    let max_work = (!max_work.is_nan()).then_some(max_work as u64);
    let limits =
        lwc::Limits { max_memory: max_memory as u64, max_vertices, max_work, ..lwc::Limits::default() };
    let mut options = lwc::DecodeOptions::new().limits(limits);
    if level != u32::MAX {
        options = options.level(level);
    }
    let slot = Slot::new(options, relative != 0, shade != 0);
    PLACES.with_borrow_mut(|places| {
        let is_free = |place: &&Place| place.try_borrow().is_ok_and(|slot| slot.is_none());
        let free = places.iter().position(is_free).unwrap_or(places.len());
        if free == places.len() {
            places.push(Box::leak(Box::default()));
        }
        places[free].replace(Some(slot));
        free as u32
    })
}

/// Forgets a decoder and frees its memory, unless a trap has taken it.
#[unsafe(no_mangle)]
pub extern "C" fn destroy(handle: u32) {
    let place = PLACES.with_borrow(|places| places.get(handle as usize).copied());
    if let Some(mut slot) = place.and_then(|place| place.try_borrow_mut().ok()) {
        *slot = None;
    }
}

/// Where the next `length` bytes of the stream are to be written.
#[unsafe(no_mangle)]
pub extern "C" fn input(handle: u32, length: u32) -> *mut u8 {
    with(handle, |slot| slot.input(length as usize))
}

/// Takes the bytes that were written. 0, or the number of an error.
#[unsafe(no_mangle)]
pub extern "C" fn feed(handle: u32) -> u32 {
    with(handle, Slot::feed)
}

/// Does about `work` units of the next pass: 0 if bytes are missing or nothing is left, 1 if the pass is
/// finished, 2 if not, otherwise the number of an error.
#[unsafe(no_mangle)]
pub extern "C" fn step(handle: u32, work: u32) -> u32 {
    with(handle, |slot| slot.step(work))
}

/// Units of work done so far.
#[unsafe(no_mangle)]
pub extern "C" fn work_done(handle: u32) -> f64 {
    with(handle, |slot| slot.work_done() as f64)
}

/// Goes through about `elements` vertices and triangles to bring positions, normals and expected error up
/// to date: 1 once they are. Asking for one of them does the rest at one go.
#[unsafe(no_mangle)]
pub extern "C" fn prepare(handle: u32, elements: u32) -> u32 {
    with(handle, |slot| u32::from(slot.prepare(elements as usize)))
}

/// What the last step changed: see `Slot::report`.
#[unsafe(no_mangle)]
pub extern "C" fn report(handle: u32) -> *const u32 {
    with(handle, |slot| slot.report().as_ptr())
}

/// Number of words at [`report`].
#[unsafe(no_mangle)]
pub extern "C" fn report_length(handle: u32) -> u32 {
    with(handle, |slot| slot.report().len() as u32)
}

/// What the stream says of itself, see `Slot::info`.
#[unsafe(no_mangle)]
pub extern "C" fn info(handle: u32) -> *const f64 {
    with(handle, |slot| slot.info().as_ptr())
}

/// Number of doubles at [`info`], 0 before the table of passes has arrived.
#[unsafe(no_mangle)]
pub extern "C" fn info_length(handle: u32) -> u32 {
    with(handle, |slot| slot.info().len() as u32)
}

/// Text of the last error, UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn message(handle: u32) -> *const u8 {
    with(handle, |slot| slot.message().as_ptr())
}

/// Bytes of [`message`].
#[unsafe(no_mangle)]
pub extern "C" fn message_length(handle: u32) -> u32 {
    with(handle, |slot| slot.message().len() as u32)
}

/// Positions, n × 3.
#[unsafe(no_mangle)]
pub extern "C" fn positions(handle: u32) -> *const f32 {
    with(handle, |slot| slot.positions().as_ptr().cast())
}

/// Unit normals of the vertices, n × 3, if they were asked for.
#[unsafe(no_mangle)]
pub extern "C" fn normals(handle: u32) -> *const f32 {
    with(handle, |slot| slot.normals().as_ptr().cast())
}

/// Grid cells, n × 3.
#[unsafe(no_mangle)]
pub extern "C" fn cells(handle: u32) -> *const i32 {
    with(handle, |slot| {
        slot.mesh().map_or(std::ptr::null(), |mesh| mesh.quantized_positions().as_ptr().cast())
    })
}

/// Vertex indices of the triangles, m × 3.
#[unsafe(no_mangle)]
pub extern "C" fn triangles(handle: u32) -> *const u32 {
    with(handle, |slot| slot.mesh().map_or(std::ptr::null(), |mesh| mesh.triangles().as_ptr().cast()))
}

/// Expected RMS distance to the finest mesh in model units, if normals were asked for.
#[unsafe(no_mangle)]
pub extern "C" fn expected_error(handle: u32) -> f64 {
    with(handle, |slot| slot.expected_error())
}

/// Checksum of the mesh (`format/SPEC.md`, section 9).
#[unsafe(no_mangle)]
pub extern "C" fn checksum(handle: u32) -> u32 {
    with(handle, |slot| slot.mesh().map_or(0, |mesh| mesh.checksum()))
}

/// 1 once the last pass of the stream, or of the wanted level, has been applied.
#[unsafe(no_mangle)]
pub extern "C" fn is_complete(handle: u32) -> u32 {
    with(handle, |slot| u32::from(slot.is_complete()))
}
