//! `clisc run` in a hostile world: whatever happens, an image is there as a whole or the old one still is.
//!
//! Where a fault cannot be made on the machine at hand, the test says so on standard error, past the capture of the
//! test runner.
#![cfg(target_os = "linux")]

mod support;

use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{Call, Folder, scene};

/// Longer than any wait here should take.
const PATIENCE: Duration = Duration::from_secs(60);

/// An image of this size takes longer than any test waits, and some megabytes.
const BIG: &str = "40000x40000";

/// The user of whom every system knows that it owns nothing.
const NOBODY: u32 = 65534;

/// Tells people that a fault could not be made.
fn say_skipped(what: &str) {
    let _ = writeln!(io::stderr(), "\nSKIPPED, the machine does not allow it: {what}");
}

#[track_caller]
fn assert_fails(call: &Call, words: &[&str]) {
    assert_eq!(call.code, Some(2), "stdout:\n{}stderr:\n{}", call.stdout, call.stderr);
    for words in words {
        assert!(call.stderr.contains(words), "`{words}` is not in:\n{}", call.stderr);
    }
    assert!(!call.stderr.contains(".clisc-"), "a temporary name is shown:\n{}", call.stderr);
}

/// Prepares a call that can be watched while it runs.
fn watched(folder: &Folder, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_clisc"));
    command.args(args).current_dir(folder.at(".")).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn a_file_in_place_of_a_folder_is_named() {
    let folder = Folder::with_scene(&scene("sub/a.png"));
    folder.put("out/sub", "a file");
    folder.put("file", "a file");
    let before = folder.listing();
    let call = folder.clisc(&["run", "a.cli", "-o", "out"]);
    assert_fails(&call, &["`out/sub/a.png`", "Not a directory"]);
    assert_fails(&folder.clisc(&["run", "a.cli", "-o", "file"]), &["`file/sub/a.png`", "Not a directory"]);
    assert_eq!(folder.listing(), before);
}

#[test]
fn a_folder_in_place_of_the_image_is_named() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("out/a.png/precious", "a file");
    let before = folder.listing();
    let call = folder.clisc(&["run", "a.cli", "-o", "out"]);
    assert_fails(&call, &["cannot create `out/a.png`", "is a directory"]);
    assert_eq!(folder.listing(), before);
}

#[test]
fn a_fault_in_one_scene_leaves_the_others() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("b.cli", scene("b.png"));
    folder.put("a.png/x", "");
    assert_fails(&folder.clisc(&["run", "a.cli", "b.cli", "--size", "4x4"]), &["`a.png`"]);
    assert_eq!(folder.image("b.png").width(), 4);
}

/// Copies the command to where every user may start it, and opens the folder for all.
fn open_to_all(folder: &Folder) {
    fs::copy(env!("CARGO_BIN_EXE_clisc"), folder.at("clisc")).unwrap();
    for path in [".", "clisc"] {
        fs::set_permissions(folder.at(path), fs::Permissions::from_mode(0o777)).unwrap();
    }
}

/// Calls the command as a user for whom permissions count: as ourselves, or as nobody when we are root.
fn clisc_without_privileges(folder: &Folder, args: &[&str]) -> Call {
    let mut command = Command::new(folder.at("clisc"));
    command.current_dir(folder.at(".")).args(args);
    let probe = folder.at("probe");
    fs::create_dir_all(&probe).unwrap();
    fs::set_permissions(&probe, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(probe.join("file"), "").is_ok() {
        command.uid(NOBODY).gid(NOBODY);
    }
    loop {
        match command.output() {
            // Another test has started a process while the command was being copied, which still holds it open for writing.
            Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => thread::sleep(Duration::from_millis(10)),
            output => return output.unwrap().into(),
        }
    }
}

#[test]
fn a_read_only_folder_is_named_and_keeps_its_image() {
    let folder = Folder::with_scene(&scene("a.png"));
    open_to_all(&folder);
    folder.put("out/a.png", "old");
    fs::set_permissions(folder.at("out/a.png"), fs::Permissions::from_mode(0o666)).unwrap();
    fs::set_permissions(folder.at("out"), fs::Permissions::from_mode(0o555)).unwrap();
    let call = clisc_without_privileges(&folder, &["run", "a.cli", "-o", "out", "--size", "4x4"]);
    assert_fails(&call, &["cannot create `out/a.png`", "Permission denied"]);
    let call = clisc_without_privileges(&folder, &["run", "a.cli", "-o", "out/new", "--size", "4x4"]);
    assert_fails(&call, &["cannot make the folder `out/new`", "Permission denied"]);
    assert_eq!(folder.bytes("out/a.png"), b"old");
    assert_eq!(fs::read_dir(folder.at("out")).unwrap().count(), 1);
    fs::set_permissions(folder.at("out"), fs::Permissions::from_mode(0o777)).unwrap();
    let call = clisc_without_privileges(&folder, &["run", "a.cli", "-o", "out", "--size", "4x4"]);
    assert_eq!(call.code, Some(0), "{}", call.stderr);
    assert_eq!(folder.image("out/a.png").width(), 4);
}

/// Whoever runs it: an administrator may write to any file, and did not mean to.
#[test]
fn a_read_only_image_is_left_as_it_is() {
    let folder = Folder::with_scene(&format!("fov 60\nwrite new.png\nwrite {}", "a.png\n"));
    folder.put("out/a.png", "old");
    fs::set_permissions(folder.at("out/a.png"), fs::Permissions::from_mode(0o444)).unwrap();
    for extra in [&[][..], &["--dry-run"]] {
        let call = folder.clisc(&[&["run", "a.cli", "-o", "out", "--size", "4x4"], extra].concat());
        assert_fails(&call, &["error[E0505]", "a.cli:3:7", "make `out/a.png` writable"]);
        assert_eq!(folder.bytes("out/a.png"), b"old");
        assert_eq!(folder.listing(), ["a.cli", "out/", "out/a.png"], "nothing is rendered");
    }
    folder.put("b.cli", scene("b.png"));
    let call = folder.clisc(&["run", "b.cli", "-o", "out/a.png"]);
    assert_fails(&call, &["error[E0505]", "make `out/a.png` writable"]);
    for args in [
        &["run", "b.cli", "--size", "4x4", "--certificate", "out/a.png"][..],
        &["bench", "b.cli", "--size", "4x4", "--repeat", "1", "--json", "out/a.png"],
    ] {
        assert_fails(&folder.clisc(args), &["`out/a.png`", "read-only"]);
        assert_eq!(folder.bytes("out/a.png"), b"old");
    }
}

#[test]
fn rights_and_attributes_of_an_image_stay() {
    use rustix::fs::{XattrFlags, getxattr, setxattr};
    let folder = Folder::with_scene(&scene("a.png"));
    let image = folder.at("a.png");
    let mode = || fs::metadata(&image).unwrap().permissions().mode() & 0o7777;
    for rights in [0o600, 0o640, 0o666, 0o200] {
        fs::write(&image, "old").unwrap();
        fs::set_permissions(&image, fs::Permissions::from_mode(rights)).unwrap();
        let has_attributes = setxattr(&image, "user.tag", b"mine", XattrFlags::empty()).is_ok();
        assert_eq!(folder.clisc(&["run", "a.cli", "--size", "4x4"]).code, Some(0));
        assert_eq!(mode(), rights);
        let mut value = [0; 8];
        match getxattr(&image, "user.tag", &mut value[..]) {
            Ok(n_bytes) => assert_eq!(&value[..n_bytes], b"mine"),
            Err(_) if !has_attributes => say_skipped("an attribute of a file"),
            Err(error) => panic!("the attribute is lost: {error}"),
        }
        fs::set_permissions(&image, fs::Permissions::from_mode(0o600)).unwrap();
        assert_eq!(folder.image("a.png").width(), 4);
    }
}

#[test]
fn what_is_no_regular_file_is_not_replaced() {
    let folder = Folder::with_scene(&scene("pipe.png"));
    assert!(Command::new("mkfifo").arg(folder.at("pipe.png")).status().unwrap().success());
    assert_fails(&folder.clisc(&["run", "a.cli", "--size", "4x4"]), &["`pipe.png`", "it is no regular file"]);
    assert_eq!(folder.listing(), ["a.cli", "pipe.png"]);
}

#[test]
fn a_folder_that_cannot_be_read_leaves_the_other_scenes() {
    let folder = Folder::new();
    folder.put("scenes/a.cli", scene("a.png"));
    folder.put("scenes/closed/b.cli", scene("b.png"));
    folder.put("scenes/open/c.cli", scene("c.png"));
    open_to_all(&folder);
    fs::set_permissions(folder.at("scenes/closed"), fs::Permissions::from_mode(0o000)).unwrap();
    let call = clisc_without_privileges(&folder, &["check", "scenes"]);
    fs::set_permissions(folder.at("scenes/closed"), fs::Permissions::from_mode(0o777)).unwrap();
    assert_fails(&call, &["cannot read the folder `scenes/closed`: Permission denied"]);
    assert!(call.stderr.ends_with("2 scenes checked: no error, no warning\n"), "{}", call.stderr);
}

/// Runs a shell script in the folder, `$CLISC` being the command.
fn shell(folder: &Folder, mut command: Command, script: &str) -> Call {
    command.args(["-c", script]).current_dir(folder.at(".")).env("CLISC", env!("CARGO_BIN_EXE_clisc"));
    command.output().unwrap().into()
}

#[test]
fn a_full_disk_keeps_the_old_image() {
    let folder = Folder::with_scene(&scene("sub/a.png"));
    folder.put("out/x", "");
    folder.put("old", "old");
    // A name space of our own, so that the mount is ours and gone at the end.
    let mut unshare = Command::new("unshare");
    unshare.args(["--user", "--map-root-user", "--mount", "sh"]);
    let call = shell(
        &folder,
        unshare,
        "mount -t tmpfs -o size=128k none out && mkdir out/sub && cp old out/sub/a.png || exit 99
         \"$CLISC\" run a.cli -o out --size 2000x2000; code=$?
         find out -type f; cat out/sub/a.png; exit $code",
    );
    if call.code == Some(99) || call.stderr.starts_with("unshare:") {
        return say_skipped("a full tmpfs; the limit on file sizes stands in for it");
    }
    assert_fails(&call, &["cannot write `out/sub/a.png`", "No space left on device"]);
    assert_eq!(call.stdout, "out/sub/a.png\nold");
}

#[test]
fn a_file_beyond_the_limit_keeps_the_old_image() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("a.png", "old");
    let before = folder.listing();
    let call =
        shell(&folder, Command::new("sh"), "trap '' XFSZ; ulimit -f 64; exec \"$CLISC\" run a.cli --size 2000x2000");
    assert_fails(&call, &["cannot write `a.png`", "File too large"]);
    assert_eq!(folder.bytes("a.png"), b"old");
    assert_eq!(folder.listing(), before);
}

/// Starts to render a big image and waits until a part of it is on the disk; tells whether its file has a name.
fn start_big(folder: &Folder) -> (Child, bool) {
    let child = watched(folder, &["run", "a.cli", "--size", BIG]).spawn().unwrap();
    let start = Instant::now();
    let has_named_file =
        || folder.listing().iter().any(|name| name.ends_with(".tmp") && !folder.bytes(name).is_empty());
    let mut has_name = false;
    while !has_name && !has_nameless_file(child.id()) {
        assert!(start.elapsed() < PATIENCE, "no file appeared");
        std::thread::sleep(Duration::from_millis(5));
        has_name = has_named_file();
    }
    (child, has_name)
}

/// Tells whether the process writes to a file that has no name.
fn has_nameless_file(pid: u32) -> bool {
    let Ok(descriptors) = fs::read_dir(format!("/proc/{pid}/fd")) else { return false };
    descriptors.flatten().any(|descriptor| {
        let is_deleted = fs::read_link(descriptor.path()).is_ok_and(|to| to.to_string_lossy().ends_with(" (deleted)"));
        is_deleted && fs::metadata(descriptor.path()).is_ok_and(|file| file.is_file() && file.len() > 0)
    })
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

fn end(mut child: Child) -> Call {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("the command does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap().into()
}

#[test]
fn a_signal_in_mid_write_leaves_the_folder_as_it_was() {
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::with_scene(&scene("a.png"));
        folder.put("a.png", "old");
        let (child, _) = start_big(&folder);
        send(signal, &child);
        let call = end(child);
        assert_eq!((call.code, call.stdout.as_str()), (Some(130), ""), "{}", call.stderr);
        assert_eq!(call.stderr, "interrupted while rendering `a.cli`\n");
        assert_eq!(folder.listing(), ["a.cli", "a.png"]);
        assert_eq!(folder.bytes("a.png"), b"old");
    }
}

#[test]
fn a_kill_in_mid_write_leaves_the_folder_as_it_was() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("a.png", "old");
    let (child, has_name) = start_big(&folder);
    send("-KILL", &child);
    assert_eq!(end(child).code, None);
    assert_eq!(has_name, !knows_nameless_files(&folder));
    if has_name {
        return say_skipped("a kill in mid-write; the file system of the temporary folder has no files without names");
    }
    assert_eq!(folder.listing(), ["a.cli", "a.png"]);
    assert_eq!(folder.bytes("a.png"), b"old");
}

/// Tells whether the file system of the folder has files without names.
fn knows_nameless_files(folder: &Folder) -> bool {
    use rustix::fs::{Mode, OFlags};
    rustix::fs::open(folder.at("."), OFlags::TMPFILE | OFlags::WRONLY, Mode::from_raw_mode(0o600)).is_ok()
}

#[test]
fn an_interrupt_ends_the_other_scenes_too() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("b.cli", scene("b.png"));
    let child = watched(&folder, &["run", "a.cli", "b.cli", "--size", BIG]).spawn().unwrap();
    let start = Instant::now();
    while !has_nameless_file(child.id()) && start.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(5));
    }
    send("-INT", &child);
    let call = end(child);
    assert_eq!(call.code, Some(130));
    assert_eq!(call.stderr.matches("interrupted").count(), 1, "{}", call.stderr);
    assert_eq!(folder.listing(), ["a.cli", "b.cli"]);
}

#[test]
fn a_signal_while_nothing_is_rendered_ends_at_once() {
    let folder = Folder::new();
    let child = watched(&folder, &["run", "-"]).stdin(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !catches_interrupts(child.id()) && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(5));
    }
    send("-INT", &child);
    assert_eq!(end(child).code, Some(130));
}

/// Tells whether the process has a handler for SIGINT, signal 2 and so bit 1 of the mask.
fn catches_interrupts(pid: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 0b10 != 0)
}

#[test]
fn results_that_nobody_reads_are_no_fault() {
    let folder = Folder::with_scene(&scene("a.png"));
    let mut child = watched(&folder, &["run", "a.cli", "--stats", "--size", "400x400"]).spawn().unwrap();
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(0), ""));
    assert_eq!(folder.image("a.png").width(), 400);
}

#[test]
fn results_that_cannot_be_written_are_a_fault() {
    let folder = Folder::with_scene(&scene("a.png"));
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = watched(&folder, &["run", "a.cli", "--size", "4x4"]).stdout(full).output().unwrap();
    assert_fails(&output.into(), &["error: cannot write to standard output: No space left on device"]);
}

#[test]
fn a_large_image_takes_no_more_memory_than_a_small_one() {
    let folder = Folder::with_scene(&scene("a.png"));
    // 9.6 MB and 79 MB of pixels, nearly half of them in rows that must be traced.
    let [small, large] = ["8000x400", "65535x400"].map(|size| {
        let args = ["run", "a.cli", "--size", size, "--threads", "2"];
        let mut child = watched(&folder, &args).spawn().unwrap();
        let mut peak_kb = 0;
        while child.try_wait().unwrap().is_none() {
            peak_kb = peak_kb.max(peak_memory_kb(child.id()).unwrap_or(0));
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!(end(child).code, Some(0));
        peak_kb
    });
    assert!(small > 0 && large < small + 8 * 1024, "{small} kB and {large} kB");
}

/// Returns the most memory a running process has had.
fn peak_memory_kb(pid: u32) -> Option<u64> {
    let status = fs::read_to_string(Path::new("/proc").join(pid.to_string()).join("status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}
