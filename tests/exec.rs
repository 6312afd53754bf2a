//! The executor against sinks that keep, refuse and break.

use std::io;
use std::panic::AssertUnwindSafe;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Duration;

use clisc::exec::{
    CancellationToken, Event, ExecError, ImageRequest, MemorySink, Observer, Options, Origin, Refusal, Sink, SinkError,
    Step, WriteReport, execute,
};
use clisc::image::{RgbImage, decode_png, encode_png};
use clisc::ir::{self, Command, Program, Registers, SceneView, Valid};
use clisc::plan::{Pass, Passes, Settings, Size, plan};
use clisc::source::Span;
use clisc::trace::Tracer;
use glam::DVec3;

const RED: Command = Command::Background(DVec3::new(1.0, 0.0, 0.0));
const BLUE: Command = Command::Background(DVec3::new(0.0, 0.0, 1.0));

fn write(name: &str) -> Command {
    Command::Write(name.into())
}

/// Makes a program; the place of its n-th command is `n..n + 1`.
fn program(commands: Vec<Command>) -> Valid {
    let mut program = Program { commands, ..Program::default() };
    program.origins.commands = (0..program.commands.len() as u32).map(|at| Span::new(at, at + 1)).collect();
    ir::validate(program).expect("a sound program")
}

fn settings(width: u32, height: u32) -> Settings {
    Settings { size: Size::new(width, height).unwrap(), ..Settings::default() }
}

fn run<S: Sink>(program: &Valid, settings: &Settings, sink: &mut S) -> Result<Vec<WriteReport>, ExecError> {
    let cancellation = &CancellationToken::new();
    execute(program, Options { settings, observer: &(), cancellation }, sink)
}

fn in_pool<T: Send>(n_threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap().install(work)
}

#[test]
fn each_write_sees_what_stands_before_it() {
    let program = program(vec![write("black.png"), RED, write("red.png"), BLUE, write("sub/blue.png"), RED]);
    let mut sink = MemorySink::default();
    let reports = run(&program, &settings(4, 3), &mut sink).unwrap();
    for (name, color) in [("black.png", [0, 0, 0]), ("red.png", [255, 0, 0]), ("sub/blue.png", [0, 0, 255])] {
        let image = decode_png(&sink.files[name]).unwrap();
        assert_eq!((image.width(), image.height()), (4, 3));
        assert!(image.rgb().chunks(3).all(|pixel| pixel == color), "{name}");
    }
    assert_eq!(
        reports.iter().map(|report| &*report.name).collect::<Vec<_>>(),
        ["black.png", "red.png", "sub/blue.png"]
    );
    for report in &reports {
        assert_eq!(report.n_bytes, sink.files[&report.name].len() as u64);
        assert_eq!(report.counts.eye_rays, 0, "rows of background are not traced");
    }
}

#[test]
fn a_later_write_of_a_name_replaces_the_earlier() {
    let mut sink = MemorySink::default();
    run(&program(vec![write("a.png"), RED, write("a.png")]), &settings(1, 1), &mut sink).unwrap();
    assert_eq!(decode_png(&sink.files["a.png"]).unwrap().rgb(), [255, 0, 0]);
}

/// A sphere that fills a part of the image, so that rows differ.
fn sphere_program() -> Valid {
    let mut program = Program { commands: vec![RED, Command::Spheres(1), write("a.png")], ..Program::default() };
    let ambient = DVec3::new(0.1, 0.5, 0.9);
    let zero = DVec3::ZERO;
    let surface =
        program.surfaces.push(ir::Surface { ambient, diffuse: zero, specular: zero, shininess: 1.0, reflectance: 0.0 });
    program.spheres.push(ir::Sphere { center: DVec3::new(0.2, 0.1, -4.0), radius: 1.0, surface, order: 0 });
    ir::validate(program).expect("a sound program")
}

#[test]
fn bands_and_threads_leave_no_trace_in_the_image() {
    let program = sphere_program();
    let settings = settings(1500, 1001);
    let mut registers = Registers::default();
    program.commands.iter().for_each(|command| registers.step(command));
    let mut whole = vec![0; 1500 * 1001 * 3];
    Tracer::new(plan(SceneView::new(&program, registers), &settings)).render_rows(0..1001, &mut whole);
    let mut files = Vec::new();
    // With many threads they share rows, with few each has bands of its own.
    for n_threads in [1, 2, 5, 20] {
        let mut sink = MemorySink::default();
        let reports = in_pool(n_threads, || run(&program, &settings, &mut sink)).unwrap();
        files.push(sink.files.remove("a.png").unwrap());
        assert_eq!(reports[0].n_bytes, files[0].len() as u64);
    }
    assert!(decode_png(&files[0]).unwrap().rgb() == whole);
    assert!(files.iter().all(|file| *file == files[0]));
    let whole = RgbImage::from_rgb(1500, 1001, whole).unwrap();
    assert!(files[0] == encode_png(&whole).unwrap(), "equal pixels give equal bytes");
}

#[test]
fn an_image_of_background_alone_is_not_traced() {
    let reports = run(&program(vec![RED, write("a.png")]), &settings(65535, 65535), &mut Forgetful).unwrap();
    assert_eq!(reports[0].counts.eye_rays, 0);
    // 13 GB of pixels.
    assert!((10_000_000..30_000_000).contains(&reports[0].n_bytes), "{} bytes", reports[0].n_bytes);
}

/// Forgets what it is given.
struct Forgetful;

impl Sink for Forgetful {
    type File = io::Sink;

    fn create(&mut self, _: &ImageRequest<'_>) -> Result<io::Sink, SinkError> {
        Ok(io::sink())
    }

    fn commit(&mut self, _: io::Sink) -> Result<(), SinkError> {
        Ok(())
    }
}

#[test]
fn refused_names_are_found_before_anything_is_rendered() {
    let program = program(vec![write("good.png"), write("/a.png"), RED, write("a/../b.png"), write(r"C:\c.png")]);
    let mut sink = MemorySink::default();
    let Err(ExecError::Refused(diagnostics)) = run(&program, &settings(1, 1), &mut sink) else { panic!("not refused") };
    let found: Vec<_> = diagnostics.iter().map(|d| (d.code.id, d.primary.span.start)).collect();
    assert_eq!(found, [("E0501", 1), ("E0502", 3), ("E0501", 4)]);
    assert!(sink.files.is_empty());
}

/// What an observer was told, in short.
#[derive(Default)]
struct Log(Mutex<Vec<String>>);

impl Observer for Log {
    fn event(&self, event: &Event<'_>) {
        self.0.lock().unwrap().push(match event {
            Event::Started { write_idx, name, size } => {
                format!("{write_idx} started {name} {}x{}", size.width(), size.height())
            }
            Event::RowsDone { write_idx, n_rows } => format!("{write_idx} rows {n_rows}"),
            Event::Finished(report) => format!("{} finished {}", report.write_idx, report.name),
            _ => "?".to_owned(),
        });
    }
}

#[test]
fn the_observer_is_told_in_order() {
    let program = program(vec![write("a.png"), RED, write("b.png")]);
    let settings = &settings(1024, 1500);
    let cancellation = &CancellationToken::new();
    let bands = (1..=94).map(|n| 1500.min(16 * n)).collect::<Vec<_>>();
    // Shared rows: without a clock each piece is twice as high as the one before.
    let pieces = vec![64, 128, 256, 512, 1024, 1500];
    for (n_threads, rows) in [(1, &bands), (3, &bands), (40, &pieces)] {
        let log = Log::default();
        let options = Options { settings, observer: &log, cancellation };
        in_pool(n_threads, || execute(&program, options, &mut MemorySink::default())).unwrap();
        let mut expected = Vec::new();
        for (idx, name) in [(0, "a.png"), (1, "b.png")] {
            expected.push(format!("{idx} started {name} 1024x1500"));
            expected.extend(rows.iter().map(|n_rows| format!("{idx} rows {n_rows}")));
            expected.push(format!("{idx} finished {name}"));
        }
        assert_eq!(log.0.into_inner().unwrap(), expected, "{n_threads} threads");
    }
}

/// Its clock ticks once a look.
#[derive(Default)]
struct Ticking(Mutex<u64>);

impl Observer for Ticking {
    fn now(&self) -> Duration {
        let mut ticks = self.0.lock().unwrap();
        *ticks += 1;
        Duration::from_secs(*ticks)
    }
}

#[test]
fn times_come_from_the_observer() {
    let cancellation = &CancellationToken::new();
    let run = |observer: &dyn Observer| {
        let options = Options { settings: &settings(1, 1), observer, cancellation };
        execute(&program(vec![write("a.png")]), options, &mut MemorySink::default()).unwrap().remove(0)
    };
    let report = run(&Ticking::default());
    assert!(report.trace_time > Duration::ZERO && report.encode_time > Duration::ZERO);
    assert_eq!(report.save_time, Duration::from_secs(1));
    assert!(report.total_time > report.save_time + report.trace_time);
    assert_eq!(run(&()).total_time, Duration::ZERO);
}

/// Cancels, or panics, when the first band is done.
struct Saboteur<'a>(Option<&'a CancellationToken>);

impl Observer for Saboteur<'_> {
    fn event(&self, event: &Event<'_>) {
        if matches!(event, Event::RowsDone { .. }) {
            self.0.expect("a token to set").cancel();
        }
    }
}

/// So many that each thread has bands of its own, and that all share rows.
const THREADS: [usize; 3] = [1, 3, 60];

#[test]
fn a_cancelled_image_is_not_committed() {
    for n_threads in THREADS {
        let token = CancellationToken::new();
        let settings = &settings(1024, 3000);
        let options = Options { settings, observer: &Saboteur(Some(&token)), cancellation: &token };
        let mut sink = MemorySink::default();
        let ended = in_pool(n_threads, || execute(&program(vec![write("a.png")]), options, &mut sink));
        assert!(matches!(ended, Err(ExecError::Cancelled)));
        assert!(sink.files.is_empty());
        assert!(token.cancel(), "it stays set");
    }
}

#[test]
fn a_cancelled_token_lets_nothing_begin() {
    let token = CancellationToken::new();
    assert!(!token.clone().cancel());
    let options = Options { settings: &settings(1, 1), observer: &(), cancellation: &token };
    let ended = execute(&program(vec![write("a.png")]), options, &mut Breaking { at: Step::Create, n_created: 0 });
    assert!(matches!(ended, Err(ExecError::Cancelled)));
}

#[test]
fn a_panic_commits_nothing() {
    for n_threads in THREADS {
        let cancellation = &CancellationToken::new();
        let options = Options { settings: &settings(1024, 3000), observer: &Saboteur(None), cancellation };
        let mut sink = MemorySink::default();
        let program = program(vec![write("a.png")]);
        let work = || in_pool(n_threads, || execute(&program, options, &mut sink));
        assert!(std::panic::catch_unwind(AssertUnwindSafe(work)).is_err());
        assert!(sink.files.is_empty());
    }
}

/// A sink that breaks at one step; at `Reach` the file cannot be written.
struct Breaking {
    at: Step,
    n_created: u32,
}

struct FullDisk;

impl io::Write for FullDisk {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Breaking {
    fn step(&self, step: Step) -> Result<(), SinkError> {
        let error = SinkError::Io { step, path: PathBuf::from("out/a.png"), source: io::ErrorKind::StorageFull.into() };
        if self.at == step { Err(error) } else { Ok(()) }
    }
}

impl Sink for Breaking {
    type File = Box<dyn io::Write + Send>;

    fn create(&mut self, _: &ImageRequest<'_>) -> Result<Self::File, SinkError> {
        self.step(Step::Create)?;
        self.n_created += 1;
        Ok(if self.at == Step::Reach { Box::new(FullDisk) } else { Box::new(io::sink()) })
    }

    fn commit(&mut self, _: Self::File) -> Result<(), SinkError> {
        self.step(Step::Save)
    }
}

#[test]
fn a_broken_sink_ends_the_execution_with_its_cause() {
    let program = program(vec![write("a.png"), write("b.png")]);
    for (at, message) in [
        (Step::Create, "cannot create `out/a.png`"),
        (Step::Reach, "cannot write `a.png`"),
        (Step::Save, "cannot save `out/a.png`"),
    ] {
        let mut sink = Breaking { at, n_created: 0 };
        let error = run(&program, &settings(2, 700), &mut sink).unwrap_err();
        assert_eq!(error.to_string(), message);
        let cause = std::error::Error::source(&error).expect("a cause");
        assert_eq!(cause.downcast_ref::<io::Error>().unwrap().kind(), io::ErrorKind::StorageFull);
        assert!(sink.n_created <= 1);
    }
}

/// A sink that knows of a link.
struct Linked;

impl Sink for Linked {
    type File = io::Sink;

    fn check(&mut self, name: &str) -> Result<(), SinkError> {
        let to = PathBuf::from("/elsewhere");
        if name.starts_with("link/") { Err(SinkError::Refused(Refusal::LinkLeadsOut { to })) } else { Ok(()) }
    }

    fn create(&mut self, _: &ImageRequest<'_>) -> Result<io::Sink, SinkError> {
        panic!("nothing is to be rendered")
    }

    fn commit(&mut self, _: io::Sink) -> Result<(), SinkError> {
        Ok(())
    }
}

#[test]
fn the_sink_may_refuse_a_name_too() {
    let program = program(vec![write("a.png"), write("link/b.png"), write("../c.png")]);
    let Err(ExecError::Refused(diagnostics)) = run(&program, &settings(1, 1), &mut Linked) else {
        panic!("not refused")
    };
    let found: Vec<_> = diagnostics.iter().map(|d| (d.code.id, d.primary.span.start)).collect();
    assert_eq!(found, [("E0503", 1), ("E0502", 2)]);
    assert_eq!(diagnostics[0].message, "the file name `link/b.png` leads out of the output folder, to `/elsewhere`");
}

/// Compiles a scene.
fn compiled(text: &str) -> Valid {
    let compilation = clisc::compile(&clisc::source::Source::new("a.cli", text));
    assert!(!compilation.has_errors(), "{text}");
    ir::validate(compilation.program).expect("a sound program")
}

/// Executes with and without the pass `writes`, on some numbers of threads; checks that the files are the same, and
/// returns where the images came from.
fn origins(text: &str, settings: &Settings) -> Vec<Origin> {
    let program = compiled(text);
    let without = Settings { passes: Passes::all().without(Pass::Writes), ..settings.clone() };
    let mut expected = MemorySink::default();
    let traced = run(&program, &without, &mut expected).unwrap();
    assert!(traced.iter().all(|report| report.origin == Origin::Traced));
    let mut origins = Vec::new();
    for n_threads in [1, 2, 20] {
        let mut sink = MemorySink::default();
        let reports = in_pool(n_threads, || run(&program, settings, &mut sink)).unwrap();
        assert!(sink == expected, "{n_threads} threads: {text}");
        for (report, traced) in reports.iter().zip(&traced) {
            assert_eq!(report.n_bytes, traced.n_bytes, "{}", report.name);
            assert!(report.counts.eye_rays <= traced.counts.eye_rays);
        }
        origins = reports.iter().map(|report| report.origin).collect();
    }
    origins
}

const BALL: &str = "fov 60\nlight 1 1 1 3 4 0\nsurface .1 .1 .1 .6 .3 .2 .2 .2 .2 9 0\nsphere -1 0 -5 1\n";

#[test]
fn one_scene_is_traced_once() {
    let settings = settings(300, 200);
    let text = format!(
        "{BALL}write a.png\nwrite b.png\nfov 30\nwrite c.png\nfov 60\nlight 0 0 0 1 1 1\n\
        sphere -1 0 -5 .5\nsphere 0 0 9 1\nwrite d.png\nwrite a.png\n"
    );
    let copied = Origin::CopiedFrom { write_idx: 0 };
    assert_eq!(origins(&text, &settings), [Origin::Traced, copied, Origin::Traced, copied, copied]);
}

#[test]
fn pixels_that_a_write_cannot_change_are_kept() {
    let settings = settings(640, 480);
    let text = format!("{BALL}write a.png\nsphere 1.5 1 -5 .3\nwrite b.png\nsphere 1.5 -1 -5 .3\nwrite c.png\n");
    let [
        Origin::Traced,
        Origin::SharedWith { write_idx: 0, n_traced_tiles, n_tiles, .. },
        Origin::SharedWith { write_idx: 1, .. },
    ] = origins(&text, &settings)[..]
    else {
        panic!("nothing is shared");
    };
    assert!(0 < n_traced_tiles && n_traced_tiles * 4 < n_tiles, "{n_traced_tiles} of {n_tiles}");
}

#[test]
fn a_copy_is_whole_or_not_there() {
    let program = compiled(&format!("{BALL}write a.png\nwrite b.png\n"));
    let settings = &settings(30, 20);
    let token = CancellationToken::new();
    let options = Options { settings, observer: &CancelsAt(1, &token), cancellation: &token };
    let mut sink = MemorySink::default();
    assert!(matches!(execute(&program, options, &mut sink), Err(ExecError::Cancelled)));
    assert_eq!(sink.files.keys().collect::<Vec<_>>(), ["a.png"]);

    let mut sink = FullAtSecond { n_created: 0 };
    let error = run(&program, settings, &mut sink).unwrap_err();
    assert_eq!(error.to_string(), "cannot write `b.png`");
}

/// Cancels when a `write` begins.
struct CancelsAt<'a>(usize, &'a CancellationToken);

impl Observer for CancelsAt<'_> {
    fn event(&self, event: &Event<'_>) {
        if matches!(event, Event::Started { write_idx, .. } if *write_idx == self.0) {
            self.1.cancel();
        }
    }
}

/// Has room for one file.
struct FullAtSecond {
    n_created: u32,
}

impl Sink for FullAtSecond {
    type File = Box<dyn io::Write + Send>;

    fn create(&mut self, _: &ImageRequest<'_>) -> Result<Self::File, SinkError> {
        self.n_created += 1;
        Ok(if self.n_created == 1 { Box::new(io::sink()) } else { Box::new(FullDisk) })
    }

    fn commit(&mut self, _: Self::File) -> Result<(), SinkError> {
        Ok(())
    }
}
