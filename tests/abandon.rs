//! Files at work that are given up. It touches all files of a program, so no other test is here.
#![cfg(feature = "io")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::io;
use std::fs;

/// Programs that are told to end call it from another thread.
#[test]
fn files_at_work_can_be_abandoned() {
    let directory = tempfile::tempdir().unwrap();
    let num_files = || fs::read_dir(&directory).unwrap().count();
    let path = directory.path().join("model.bin");
    let written = io::write_atomic(&path, |out| {
        out.write_all(b"half")?;
        assert_eq!(num_files(), 1);
        assert_eq!(io::abandon_writes(num_files), 0);
        Ok::<(), std::io::Error>(())
    });
    assert!(written.is_err(), "there is nothing to rename");
    assert_eq!((num_files(), io::abandon_writes(|| 7)), (0, 7));
    io::write_atomic(&path, |out| out.write_all(b"whole")).unwrap();
    assert_eq!(io::abandon_writes(num_files), 1, "finished files are no longer at work");
}
