//! The language server as an editor talks to it: the real binary, frames on its standard input and output.

mod support;

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};

/// How long an answer may take before the test gives up; generous, since nothing is measured here.
const PATIENCE: Duration = Duration::from_secs(120);

const URI: &str = "file:///home/me/my%20scene.cli";

const SCENE: &str = "fov 60\nlight 1 1 1 0 0 5 # π 😀 sun\n\nsurface 0.1 0 0 0.8 .2 .2 0 0 0 1 0\nsphere 0 0 -4 1\nwrite \"my scene.png\"\n";

/// An editor with one document, of which it keeps the text as it believes it to be.
struct Editor {
    server: Child,
    stdin: Option<ChildStdin>,
    frames: Receiver<Value>,
    /// What has come and nobody has asked for yet.
    waiting: VecDeque<Value>,
    n_requests: i32,
    text: String,
    version: i32,
}

impl Editor {
    /// Starts a server and says nothing.
    fn silent() -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_clisc"));
        command.args(["lsp", "--stdio"]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = command.spawn().expect("a server that starts");
        let mut stdout = BufReader::new(server.stdout.take().expect("a pipe"));
        let (sender, frames) = channel();
        thread::spawn(move || {
            while let Some(frame) = read_frame(&mut stdout) {
                let _ = sender.send(frame);
            }
        });
        let stdin = server.stdin.take();
        Self { server, stdin, frames, waiting: VecDeque::new(), n_requests: 0, text: String::new(), version: 0 }
    }

    /// Starts a server and agrees with it on the encoding of places.
    fn with_encodings(encodings: &[&str]) -> Self {
        Self::introduced(encodings, json!({}))
    }

    /// Starts a server, agrees with it on the encoding of places, and tells it more about the editor.
    fn introduced(encodings: &[&str], further: Value) -> Self {
        let mut editor = Self::silent();
        let mut params = json!({ "processId": null, "rootUri": null, "capabilities": {
                "general": { "positionEncodings": encodings },
                "workspace": {
                    "workspaceEdit": { "documentChanges": true },
                    "didChangeWatchedFiles": { "dynamicRegistration": true },
                },
                "textDocument": {
                    "completion": { "completionItem": { "snippetSupport": true } },
                    "hover": { "contentFormat": ["markdown"] },
                    "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
                    "codeAction": { "codeActionLiteralSupport": { "codeActionKind": { "valueSet": [] } } },
                    "publishDiagnostics": { "relatedInformation": true },
                },
            } });
        let further = further.as_object().expect("an object").clone();
        params.as_object_mut().expect("an object").extend(further);
        let answer = editor.ask("initialize", params);
        let chosen = encodings.first().copied().unwrap_or("utf-16");
        assert_eq!(answer["capabilities"]["positionEncoding"], chosen);
        editor.note("initialized", json!({}));
        let wish = editor.wait_for(|frame| frame["method"] == "client/registerCapability");
        let registration = &wish["params"]["registrations"][0];
        assert_eq!(registration["method"], "workspace/didChangeWatchedFiles");
        assert_eq!(registration["registerOptions"]["watchers"][0]["globPattern"], "**/clisc.toml");
        editor.send(&json!({ "jsonrpc": "2.0", "id": wish["id"], "result": null }));
        editor
    }

    /// Starts a server that counts bytes and opens a document.
    fn open(text: &str) -> Self {
        let mut editor = Self::with_encodings(&["utf-8"]);
        editor.open_text(text);
        editor
    }

    fn open_text(&mut self, text: &str) {
        (self.text, self.version) = (text.to_owned(), 1);
        self.open_at(URI, text);
    }

    /// Opens a document at another address, which is the test's own to keep.
    fn open_at(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "cli", "version": 1, "text": text });
        self.note("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Waits for what is told next of an address.
    fn told_of(&mut self, uri: &str) -> Vec<Value> {
        let told = self
            .wait_for(|frame| frame["method"] == "textDocument/publishDiagnostics" && frame["params"]["uri"] == uri);
        told["params"]["diagnostics"].as_array().expect("a list").clone()
    }

    /// Tells whether what is told next of an address says that a scene has no `fov`.
    fn misses_fov(&mut self, uri: &str) -> bool {
        self.told_of(uri).iter().any(|found| found["code"] == "W0302")
    }

    fn send_bytes(&mut self, bytes: &[u8]) {
        let stdin = self.stdin.as_mut().expect("an open pipe");
        stdin.write_all(bytes).and_then(|()| stdin.flush()).expect("a server that reads");
    }

    fn send(&mut self, message: &Value) {
        self.send_bytes(frame(message).as_bytes());
    }

    fn note(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request and returns its whole answer.
    fn request(&mut self, method: &str, params: Value) -> Value {
        self.n_requests += 1;
        let id = self.n_requests;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        self.wait_for(|frame| frame["id"] == id)
    }

    /// Sends a request and returns its result.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.request(method, params);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].clone()
    }

    /// Asks about the open document, with further parameters.
    fn ask_about(&mut self, method: &str, mut params: Value) -> Value {
        params["textDocument"] = json!({ "uri": URI });
        self.ask(&format!("textDocument/{method}"), params)
    }

    /// Asks about a place.
    fn ask_at(&mut self, method: &str, line: u32, character: u32) -> Value {
        self.ask_about(method, json!({ "position": { "line": line, "character": character } }))
    }

    fn wait_for(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Value {
        if let Some(at) = self.waiting.iter().position(&is_wanted) {
            return self.waiting.remove(at).expect("a frame");
        }
        loop {
            let frame = self.frames.recv_timeout(PATIENCE).expect("an answer");
            if is_wanted(&frame) {
                return frame;
            }
            self.waiting.push_back(frame);
        }
    }

    /// Waits for what is wrong with the text as it stands.
    fn diagnostics(&mut self) -> Vec<Value> {
        let version = self.version;
        let told = self.wait_for(|frame| {
            frame["method"] == "textDocument/publishDiagnostics" && frame["params"]["version"] == version
        });
        assert_eq!(told["params"]["uri"], URI);
        told["params"]["diagnostics"].as_array().expect("a list").clone()
    }

    fn codes(&mut self) -> Vec<String> {
        self.diagnostics().iter().map(|found| found["code"].as_str().expect("a code").to_owned()).collect()
    }

    /// Types: replaces the text in a range, given in bytes.
    fn edit(&mut self, range: Value, text: &str) {
        self.text.replace_range(self.bytes(&range), text);
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let changes = json!([{ "range": range, "text": text }]);
        self.note("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Carries out the edits of an answer, from the end of the text to its start, as one change.
    fn carry_out(&mut self, edits: &[Value]) {
        let mut edits = edits.to_vec();
        edits.sort_by_key(|edit| std::cmp::Reverse(self.bytes(&edit["range"]).start));
        for edit in &edits {
            let text = edit["newText"].as_str().expect("a text");
            self.text.replace_range(self.bytes(&edit["range"]), text);
        }
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let changes: Vec<_> =
            edits.iter().map(|edit| json!({ "range": edit["range"], "text": edit["newText"] })).collect();
        self.note("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    fn bytes(&self, range: &Value) -> std::ops::Range<usize> {
        let offset = |place: &Value| {
            let (line, column) =
                (place["line"].as_u64().expect("a line"), place["character"].as_u64().expect("a column"));
            let before: usize = self.text.split_inclusive('\n').take(line as usize).map(str::len).sum();
            (before + column as usize).min(self.text.len())
        };
        offset(&range["start"])..offset(&range["end"])
    }

    /// Returns the text in a range.
    fn slice(&self, range: &Value) -> &str {
        &self.text[self.bytes(range)]
    }

    /// Says goodbye and returns the exit code.
    fn leave(mut self) -> Option<i32> {
        self.ask("shutdown", Value::Null);
        self.note("exit", Value::Null);
        self.end()
    }

    /// Closes the pipe and returns the exit code.
    fn end(mut self) -> Option<i32> {
        drop(self.stdin.take());
        self.server.wait().expect("an end").code()
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn frame(message: &Value) -> String {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len())
}

fn read_frame(input: &mut impl BufRead) -> Option<Value> {
    let mut n_bytes = 0;
    loop {
        let mut line = String::new();
        if input.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end().split_once(": ") {
            Some(("Content-Length", n)) => n_bytes = n.parse().expect("a length"),
            Some(_) => {}
            None => break,
        }
    }
    let mut body = vec![0; n_bytes];
    input.read_exact(&mut body).ok()?;
    Some(serde_json::from_slice(&body).expect("a frame of JSON"))
}

fn range(start: (u32, u32), end: (u32, u32)) -> Value {
    let place = |(line, character): (u32, u32)| json!({ "line": line, "character": character });
    json!({ "start": place(start), "end": place(end) })
}

/// Open, type an error, see it, take the fix, format; nothing that has passed is told again.
#[test]
fn a_session() {
    let mut editor = Editor::open(SCENE);
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);

    // A letter too few, typed in three steps of which only the last is told of.
    editor.edit(range((4, 0), (4, 6)), "s");
    editor.edit(range((4, 1), (4, 1)), "ph");
    editor.edit(range((4, 3), (4, 3)), "ere".strip_prefix('e').expect("letters"));
    assert_eq!(editor.text.lines().nth(4), Some("sphre 0 0 -4 1"));
    let found = editor.diagnostics();
    let [error] = &found[..] else { panic!("{found:?}") };
    assert_eq!((&error["code"], &error["severity"], &error["source"]), (&"E0201".into(), &1.into(), &"clisc".into()));
    assert_eq!(editor.slice(&error["range"]), "sphre");
    assert!(error["message"].as_str().expect("a message").contains("did you mean `sphere`"), "{error}");

    let context = json!({ "diagnostics": found });
    let actions = editor.ask_about("codeAction", json!({ "range": range((4, 2), (4, 2)), "context": context }));
    let [fix, ..] = actions.as_array().expect("a list").as_slice() else { panic!("{actions}") };
    assert_eq!((&fix["kind"], &fix["diagnostics"][0]["code"]), (&"quickfix".into(), &"E0201".into()));
    let change = &fix["edit"]["documentChanges"][0];
    assert_eq!(change["textDocument"], json!({ "uri": URI, "version": editor.version }));
    editor.carry_out(change["edits"].as_array().expect("a list"));
    assert_eq!(editor.text, SCENE);
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);

    let edits = editor.ask_about("formatting", json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
    editor.carry_out(edits.as_array().expect("a list"));
    let folder = support::Folder::with_scene(SCENE);
    folder.clisc(&["fmt", "a.cli"]);
    assert_eq!(editor.text.as_bytes(), folder.bytes("a.cli"), "as on the command line");
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);
    let again = editor.ask_about("formatting", json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
    assert_eq!(again, json!([]));

    let told: Vec<_> = editor.waiting.iter().map(|frame| frame["params"]["version"].as_i64()).collect();
    assert!(told.is_empty(), "versions that had passed were told of: {told:?}");
    assert_eq!(editor.leave(), Some(0));
}

#[test]
fn columns_count_what_was_agreed() {
    let scene = "write \"π😀é.png\" x # 😀\n";
    for (encodings, column) in [(&["utf-8"][..], 22), (&["utf-16", "utf-8"], 18), (&["utf-32"], 17), (&[], 18)] {
        let mut editor = Editor::with_encodings(encodings);
        editor.open_text(scene);
        let found = editor.diagnostics();
        let error = found.iter().find(|found| found["severity"] == 1).expect("an error");
        let end = &error["range"]["end"];
        assert!(end["character"] == column - 1 || end["character"] == column, "{encodings:?}: {error}");
        // The `x` is taken away; behind the emoji a letter is typed.
        let document = json!({ "uri": URI, "version": 2 });
        let changes = json!([
            { "range": range((0, column - 2), (0, column)), "text": "" },
            { "range": range((0, column), (0, column)), "text": "z" },
        ]);
        editor.note("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
        editor.version = 2;
        assert!(editor.diagnostics().iter().all(|found| found["severity"] != 1), "{encodings:?}");
    }
}

#[test]
fn hover_tells_what_a_number_means() {
    let mut editor = Editor::open(SCENE);
    let mut told = |line, column| {
        let hover = editor.ask_at("hover", line, column);
        assert!(hover.is_null() || hover["contents"]["kind"] == "markdown");
        hover["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    let number = told(3, 17);
    assert!(number.contains("`Cdr` of `surface`: diffuse red") && number.contains("From 0 to 1"), "{number}");
    assert!(number.contains("the diffuse colour (`Cd`): red, `#cc3333`"), "{number}");
    assert!(told(0, 5).contains("In degrees, above 0 and below 180"));
    let sphere = told(4, 0);
    assert!(sphere.contains("sphere x y z radius") && sphere.contains("set in line 4"), "{sphere}");
    assert!(told(5, 8).contains("ends in `.png`"));
    assert_eq!((told(1, 20), told(2, 0)), (String::new(), String::new()));
}

#[test]
fn completion_offers_commands_values_and_names() {
    let scene =
        "surface 0 0 0 0.8 0.2 0.2 0 0 0 1 0\nsurface 1 0 0 0.8 0.2 0.2 0 0 0 9 0\nsu\nsurface 0 0 0 \nwrite \n#\n";
    let mut editor = Editor::open(scene);
    let mut offered = |line, column| editor.ask_at("completion", line, column).as_array().expect("a list").clone();
    let commands = offered(2, 2);
    assert_eq!(commands.len(), 7);
    let sphere = commands.iter().find(|item| item["label"] == "sphere").expect("a sphere");
    assert_eq!(sphere["textEdit"]["newText"], "sphere ${1:x} ${2:y} ${3:z}   ${4:radius}");
    assert_eq!((&sphere["textEdit"]["range"], &sphere["insertTextFormat"]), (&range((2, 0), (2, 2)), &2.into()));
    let colors = offered(3, 14);
    assert_eq!(colors.len(), 1);
    assert_eq!((&colors[0]["label"], &colors[0]["kind"]), (&"0.8 0.2 0.2".into(), &16.into()));
    assert_eq!(colors[0]["detail"], "red, used 2 times");
    let in_place = offered(0, 15);
    assert_eq!(in_place[0]["textEdit"], json!({ "range": range((0, 14), (0, 25)), "newText": "0.8 0.2 0.2" }));
    assert_eq!(offered(4, 6)[0]["textEdit"]["newText"], "\"my scene.png\"");
    assert_eq!(offered(5, 1)[0]["label"], "# clisc: off");
    assert!(offered(0, 3).iter().any(|item| item["label"] == "surface"));
}

#[test]
fn signature_help_counts_arguments() {
    let mut editor = Editor::open("sphere 1 2 \nsphere 1 2 3 4 \nsphere 1 # 2\nfoo 1\n");
    let help = editor.ask_at("signatureHelp", 0, 11);
    assert_eq!((&help["activeParameter"], &help["signatures"][0]["label"]), (&2.into(), &"sphere x y z radius".into()));
    assert_eq!(help["signatures"][0]["parameters"][2]["label"], json!([11, 12]));
    assert_eq!(editor.ask_at("signatureHelp", 0, 10)["activeParameter"], 1);
    for (line, column) in [(1, 15), (2, 12), (3, 5), (0, 3)] {
        assert!(editor.ask_at("signatureHelp", line, column).is_null(), "{line}:{column}");
    }
}

#[test]
fn a_colour_picker_edits_every_colour() {
    let mut editor = Editor::open(SCENE);
    let colors = editor.ask_about("documentColor", json!({}));
    let shown: Vec<_> = colors.as_array().expect("a list").iter().map(|color| editor.slice(&color["range"])).collect();
    assert_eq!(shown, ["1 1 1", "0.1 0 0", "0.8 .2 .2", "0 0 0"]);
    let color = json!({ "red": 0.2, "green": 1.0, "blue": 0.0, "alpha": 1.0 });
    let offered = editor.ask_about("colorPresentation", json!({ "color": color, "range": colors[2]["range"] }));
    assert_eq!((&offered[0]["label"], &offered[0]["textEdit"]["newText"]), (&"0.2 1 0".into(), &"0.2 1 0".into()));
    editor.carry_out(&[offered[0]["textEdit"].clone()]);
    assert_eq!(editor.text.lines().nth(3), Some("surface 0.1 0 0 0.2 1 0 0 0 0 1 0"));
}

#[test]
fn hints_name_the_numbers_of_a_range() {
    let mut editor = Editor::open(SCENE);
    let hints = editor.ask_about("inlayHint", json!({ "range": range((3, 0), (4, 0)) }));
    let hints: Vec<_> =
        hints.as_array().expect("a list").iter().map(|hint| (&hint["label"], &hint["position"])).collect();
    let labels: Vec<_> = hints.iter().map(|(label, _)| label.as_str().expect("a label")).collect();
    assert_eq!(labels, ["Ca:", "Cd:", "Cs:", "P:", "Krefl:"]);
    assert_eq!(hints[1].1, &json!({ "line": 3, "character": 16 }));
}

#[test]
fn an_outline_has_objects_below_their_surface_and_folds() {
    let scene = "# a\n# b\nfov 60\nsurface 0 0 0 1 1 1 0 0 0 1 0\nsphere 0 0 -4 1\ncylinder 1 0 -4 0 1\n\n# clisc: off\nwrite a.png\n# clisc: on\n";
    let mut editor = Editor::open(scene);
    let symbols = editor.ask_about("documentSymbol", json!({}));
    let names: Vec<_> = symbols.as_array().expect("a list").iter().map(|symbol| symbol["name"].as_str()).collect();
    assert_eq!(names, [Some("fov"), Some("surface"), Some("write")]);
    let surface = &symbols[1];
    assert_eq!((&surface["range"], &surface["children"][1]["name"]), (&range((3, 0), (5, 19)), &"cylinder".into()));
    let folds = editor.ask_about("foldingRange", json!({}));
    let folds: Vec<_> =
        folds.as_array().expect("a list").iter().map(|fold| (&fold["startLine"], &fold["endLine"])).collect();
    assert_eq!(folds, [(&0.into(), &1.into()), (&3.into(), &5.into()), (&7.into(), &9.into())]);
}

#[test]
fn tokens_are_told_whole_in_part_and_as_they_change() {
    let mut editor = Editor::open(SCENE);
    let whole = editor.ask_about("semanticTokens/full", json!({}));
    let data = whole["data"].as_array().expect("numbers").clone();
    // `fov`, `60`, `light` on the next line, and its six numbers.
    assert_eq!(data[..15], [0, 0, 3, 0, 0, 0, 4, 2, 1, 0, 1, 0, 5, 0, 0].map(Value::from));
    let part = editor.ask_about("semanticTokens/range", json!({ "range": range((5, 0), (5, 3)) }));
    assert_eq!(part["data"], json!([5, 0, 5, 0, 0, 0, 6, 14, 2, 0]));
    editor.edit(range((0, 4), (0, 6)), "7");
    let delta = editor.ask_about("semanticTokens/full/delta", json!({ "previousResultId": whole["resultId"] }));
    assert_eq!(delta["edits"], json!([{ "start": 5, "deleteCount": 5, "data": [0, 4, 1, 1, 0] }]));
    let anew = editor.ask_about("semanticTokens/full/delta", json!({ "previousResultId": "none" }));
    assert_eq!(anew["data"].as_array().map(Vec::len), Some(data.len()));
}

#[test]
fn surfaces_and_names_are_found() {
    let scene = "surface 0 0 0 1 1 1 0 0 0 1 0\nsphere 0 0 -4 1\nwrite a.png\ncylinder 1 0 -4 0 1\n\
                 surface 1 0 0 1 1 1 0 0 0 1 0\nsphere 0 0 -5 1\nwrite \"a.png\"\n";
    let mut editor = Editor::open(scene);
    let definition = editor.ask_at("definition", 3, 4);
    assert_eq!((&definition["uri"], &definition["range"]), (&URI.into(), &range((0, 0), (0, 29))));
    assert!(editor.ask_at("definition", 2, 4).is_null());
    let mut lines = |line: u32, with_surface: bool| {
        let place = json!({ "line": line, "character": 1 });
        let context = json!({ "includeDeclaration": with_surface });
        let found = editor.ask_about("references", json!({ "position": place, "context": context }));
        let lines = found.as_array().expect("a list").iter().map(|place| place["range"]["start"]["line"].as_u64());
        lines.map(|line| line.expect("a line")).collect::<Vec<_>>()
    };
    assert_eq!((lines(0, false), lines(3, true), lines(5, true)), (vec![1, 3], vec![0, 1, 3], vec![4, 5]));
    let highlights = editor.ask_at("documentHighlight", 5, 0);
    assert_eq!((&highlights[0]["kind"], &highlights[1]["kind"]), (&3.into(), &2.into()));
    assert_eq!(editor.ask_at("documentHighlight", 2, 8).as_array().map(Vec::len), Some(2));

    assert_eq!(editor.ask_at("prepareRename", 6, 9)["placeholder"], "a.png");
    assert!(editor.ask_at("prepareRename", 1, 9).is_null());
    let rename = |line: u32, name: &str| json!({ "textDocument": { "uri": URI }, "position": { "line": line, "character": 8 }, "newName": name });
    let edit = editor.ask("textDocument/rename", rename(2, "two words.png"));
    editor.carry_out(edit["documentChanges"][0]["edits"].as_array().expect("a list"));
    assert_eq!(editor.text.matches("\"two words.png\"\n").count(), 2);
    for (line, name) in [(2, "a.jpg"), (2, "../a.png"), (2, "a\nb.png"), (2, ""), (1, "b.png")] {
        let answer = editor.request("textDocument/rename", rename(line, name));
        assert_eq!(answer["error"]["code"], -32803, "{name}: {answer}");
    }
}

#[test]
fn a_range_is_formatted_alone() {
    let mut editor = Editor::open("fov  60\nlight 1 1 1 0 0 5\nlight 1 1 1 10 0 5\n");
    let options = json!({ "tabSize": 4, "insertSpaces": true });
    let edits = editor.ask_about("rangeFormatting", json!({ "range": range((1, 0), (2, 0)), "options": options }));
    editor.carry_out(edits.as_array().expect("a list"));
    assert_eq!(editor.text, "fov  60\nlight 1 1 1    0 0 5\nlight 1 1 1 10 0 5\n");
}

#[test]
fn all_safe_fixes_are_one_action() {
    let mut editor =
        Editor::open("fov 60\nlite 1 1 1 0 0 5\nsurfac 1 1 1 1 1 1 1 1 1 1 1\nshpere 0 0 -4 1\nwrite a.png\n");
    assert!(editor.codes().len() >= 3);
    let context = json!({ "diagnostics": [], "only": ["source.fixAll"] });
    let actions = editor.ask_about("codeAction", json!({ "range": range((0, 0), (0, 0)), "context": context }));
    for action in actions.as_array().expect("a list") {
        assert_eq!(action["kind"], "source.fixAll.clisc");
        editor.carry_out(action["edit"]["documentChanges"][0]["edits"].as_array().expect("a list"));
        assert!(editor.codes().iter().all(|code| code != "E0201"), "{}", editor.text);
    }
}

/// While a `write` is being typed, what only it would show stays.
#[test]
fn no_safe_fix_removes_anything_while_a_line_is_wrong() {
    let context = || json!({ "diagnostics": [], "only": ["source.fixAll"] });
    for write in ["write ", "writ a.png", "write a.jp", "save a.png", "wr"] {
        for object in ["sphere 0 0 -10 1", "sphere 0 0 -10 5", "light 0 0 0  9 9 9"] {
            let mut editor = Editor::open(&format!(
                "fov 60\nlight 1 1 1 0 5 0\nsurface 0.1 0.6 0.1 0.3 0.3 0.3 0 0 0 1 0\n{object}\n{write}\nsphere 0 0 -10 5\nwrite b.png\n"
            ));
            assert!(editor.codes().iter().any(|code| code.starts_with('E')), "{}", editor.text);
            let actions =
                editor.ask_about("codeAction", json!({ "range": range((0, 0), (0, 0)), "context": context() }));
            assert_eq!(actions, json!([]), "{}", editor.text);
            let all = json!({ "range": range((0, 0), (7, 0)), "context": { "diagnostics": [] } });
            let actions = editor.ask_about("codeAction", all);
            let removes = |action: &&Value| action["title"].as_str().is_some_and(|title| title.starts_with("remove"));
            let preferred: Vec<_> = actions
                .as_array()
                .expect("a list")
                .iter()
                .filter(removes)
                .filter(|action| action["isPreferred"] == true)
                .collect();
            assert!(preferred.is_empty(), "{preferred:?}");
        }
    }
}

/// Names and colours of the command table are those of 2018: in a scene of another edition they would be wrong.
#[test]
fn a_scene_of_another_edition_is_one_finding_without_a_fix() {
    let mut editor = Editor::open(
        "fov 60\nlight 0 4 5  1 1 1\nsurface .8 .2 .2  .1 0 0  0 0 0  1 0\nsphere 1  0 0 -4\nwrite a.png\n",
    );
    assert_eq!(editor.codes(), ["E0302"]);
    let all = json!({ "range": range((0, 0), (5, 0)), "context": { "diagnostics": [] } });
    assert_eq!(editor.ask_about("codeAction", all), json!([]));
    assert_eq!(editor.ask_about("documentColor", json!({})), json!([]));
    assert!(editor.ask_at("hover", 3, 8).is_null() && editor.ask_at("signatureHelp", 3, 8).is_null());
    assert_eq!(editor.ask_about("inlayHint", json!({ "range": range((0, 0), (5, 0)) })), json!([]));
    assert_eq!(editor.ask_about("formatting", json!({ "options": { "tabSize": 4, "insertSpaces": true } })), json!([]));
}

#[test]
fn a_comment_allows_a_finding_as_everywhere() {
    let mut editor = Editor::open("light 1 1 1 0 0 5\nwrite \"my scene.png\"\n");
    assert!(editor.codes().contains(&"W0302".to_owned()));
    let context = json!({ "diagnostics": [] });
    let actions = editor.ask_about("codeAction", json!({ "range": range((1, 0), (1, 5)), "context": context }));
    let is_allow = |action: &&Value| action["title"] == "allow it here: `# clisc: allow(no-fov)`";
    let allow = actions.as_array().expect("a list").iter().find(is_allow).expect("a way to allow it");
    editor.carry_out(allow["edit"]["documentChanges"][0]["edits"].as_array().expect("a list"));
    assert_eq!(editor.text.lines().nth(1), Some("# clisc: allow(no-fov)"));
    assert!(!editor.codes().contains(&"W0302".to_owned()));
    let page = editor.ask_at("hover", 1, 12);
    assert!(
        page["contents"]["value"].as_str().is_some_and(|page| page.contains("no `fov` before a `write`")),
        "{page}"
    );
    let rules = editor.ask_at("completion", 1, 18);
    assert!(rules.as_array().expect("a list").iter().any(|rule| rule["label"] == "unused-surface"));
    assert_eq!(rules[0]["textEdit"]["range"], range((1, 15), (1, 18)));
}

/// Of a scene full of mistakes the first hundreds are shown, errors first, and the others are counted.
#[test]
fn a_great_many_findings_are_counted() {
    let mut editor = Editor::open(&("surface 0 0 0 0 0 0 0 0 0 1 0\n".repeat(10) + &"sphere 0\n".repeat(12_000)));
    let found = editor.diagnostics();
    let (last, shown) = found.split_last().expect("findings");
    assert_eq!(shown.len(), 300);
    assert!(shown.iter().all(|found| found["severity"] == 1), "errors come first");
    assert_eq!(last["range"], range((310, 0), (310, 6)), "at the first that is left out");
    let message = last["message"].as_str().expect("a message");
    assert!(message.starts_with("… and 117") && message.contains("11700 errors, "), "{message}");
    assert_eq!(editor.leave(), Some(0));
}

const NO_FOV: &str = "light 1 1 1 0 0 5\nwrite \"a.png\"\n";
const ALLOWED: &str = "[lint.rules]\nno-fov = \"off\"\n";

/// A folder whose name needs escapes, and the address of a file in it.
fn folder_and_uri() -> (support::Folder, impl Fn(&str) -> String) {
    let folder = support::Folder::new();
    folder.put("scénes %41/b/a.cli", "");
    let root = folder.at("").canonicalize().expect("a folder");
    (folder, move |name| format!("file://{}/sc%C3%A9nes%20%2541/{name}", root.display()))
}

/// A change of `clisc.toml` is seen, whether or not the editor tells of it; while it is broken, it says so at its place, and
/// what it said before holds.
#[test]
fn a_change_of_the_configuration_is_seen() {
    let (folder, uri) = folder_and_uri();
    let (scene, config) = (uri("b/a.cli"), uri("clisc.toml"));
    let put = |text: &str| folder.put("scénes %41/clisc.toml", text);
    let mut editor = Editor::with_encodings(&["utf-16"]);
    editor.open_at(&scene, NO_FOV);
    assert!(editor.misses_fov(&scene), "there is no configuration");

    put(ALLOWED);
    assert!(!editor.misses_fov(&scene), "seen without being told of");

    put("[lint.rules]\n\"é😀\" = \"off\"\n");
    let changes = json!({ "changes": [{ "uri": config, "type": 2 }] });
    editor.note("workspace/didChangeWatchedFiles", changes.clone());
    let faults = editor.told_of(&config);
    let [fault] = &faults[..] else { panic!("{faults:?}") };
    assert_eq!((&fault["severity"], &fault["range"]), (&1.into(), &range((1, 0), (1, 13))));
    assert!(fault["message"].as_str().expect("a message").contains("there is no rule `é😀`"), "{fault}");
    assert!(!editor.misses_fov(&scene), "what it said before holds");

    put("[lint.rules]\nno-fov = \"warning\" x\n");
    editor.note("workspace/didChangeWatchedFiles", changes.clone());
    assert_eq!(editor.told_of(&config)[0]["range"]["start"], json!({ "line": 1, "character": 19 }));
    assert!(!editor.misses_fov(&scene), "what it said before still holds");

    put("[lint.rules]\nno-fov = \"warning\"\n");
    editor.note("workspace/didChangeWatchedFiles", changes.clone());
    assert_eq!(editor.told_of(&config), [] as [Value; 0], "mended");
    assert!(editor.misses_fov(&scene));

    put("[lint\n");
    editor.note("workspace/didChangeWatchedFiles", changes);
    assert_eq!(editor.told_of(&config).len(), 1);
    editor.note("textDocument/didClose", json!({ "textDocument": { "uri": scene } }));
    assert_eq!(editor.told_of(&config), [] as [Value; 0], "nobody uses it any more");
    assert_eq!(editor.leave(), Some(0));
}

/// However an address is written, the nearest `clisc.toml` counts; for what is no file, that of the folder that is open.
#[test]
fn every_address_finds_its_configuration() {
    let (folder, uri) = folder_and_uri();
    folder.put("scénes %41/clisc.toml", ALLOWED);
    let with_three = uri("b/a.cli");
    let path = with_three.strip_prefix("file://").expect("a file");
    let further = json!({ "workspaceFolders": [{ "uri": uri("b"), "name": "b" }] });
    let mut editor = Editor::introduced(&["utf-8"], further);
    for uri in [&with_three, &format!("file:{path}"), &format!("file://localhost{path}"), "untitled:Untitled-1"] {
        editor.open_at(uri, NO_FOV);
        assert!(!editor.misses_fov(uri), "{uri}");
    }
    editor.open_at("file:///nowhere/a.cli", NO_FOV);
    assert!(editor.misses_fov("file:///nowhere/a.cli"));
    assert_eq!(editor.leave(), Some(0));
    for further in [json!({ "rootUri": uri("b") }), json!({ "rootPath": folder.at("scénes %41/b") })] {
        let mut editor = Editor::introduced(&["utf-8"], further);
        editor.open_at("untitled:Untitled-1", NO_FOV);
        assert!(!editor.misses_fov("untitled:Untitled-1"));
    }
}

/// A server whose editor has died ends, also if somebody else keeps its pipes open.
#[test]
fn the_server_ends_with_its_editor() {
    let mut short_lived =
        Command::new(env!("CARGO_BIN_EXE_clisc")).arg("lsp").stdin(Stdio::piped()).spawn().expect("a process");
    let mut editor = Editor::introduced(&["utf-8"], json!({ "processId": short_lived.id() }));
    editor.open_text(SCENE);
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);
    assert_eq!(editor.server.try_wait().expect("a state"), None, "the editor lives");
    drop(short_lived.stdin.take());
    short_lived.wait().expect("an end");
    assert_eq!(editor.server.wait().expect("an end").code(), Some(1));
}

#[test]
fn what_is_closed_is_forgotten() {
    let mut editor = Editor::open("fov 0\n");
    assert!(editor.codes().contains(&"E0401".to_owned()));
    editor.note("textDocument/didClose", json!({ "textDocument": { "uri": URI } }));
    let told = editor.wait_for(|frame| frame["method"] == "textDocument/publishDiagnostics");
    assert_eq!(told["params"]["diagnostics"], json!([]));
    let place = json!({ "textDocument": { "uri": URI }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.request("textDocument/hover", place)["error"]["code"], -32602);
    editor.note("textDocument/didClose", json!({ "textDocument": { "uri": URI } }));
    editor.open_text("fov 60\nwrite \"my scene.png\"\n");
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);
}

#[test]
fn what_is_not_understood_does_no_harm() {
    let mut editor = Editor::silent();
    let hover = json!({ "textDocument": { "uri": URI }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.request("textDocument/hover", hover.clone())["error"]["code"], -32002);
    editor.note("textDocument/didOpen", json!({ "nothing": 1 }));
    editor.ask("initialize", json!({ "capabilities": { "textDocument": 7, "general": { "positionEncodings": [3] } } }));
    assert_eq!(editor.request("initialize", json!({}))["error"]["code"], -32600);
    editor.send_bytes(b"Content-Length: 5\r\n\r\n{oops");
    assert_eq!(editor.wait_for(|frame| frame["id"].is_null() && !frame["error"].is_null())["error"]["code"], -32700);
    editor.send_bytes(b"what is this\r\n\r\n");
    assert_eq!(editor.wait_for(|frame| frame["id"].is_null() && !frame["error"].is_null())["error"]["code"], -32700);
    editor.send(&json!({ "jsonrpc": "2.0", "id": "a", "method": 7 }));
    assert_eq!(editor.wait_for(|frame| frame["id"] == "a")["error"]["code"], -32600);
    assert_eq!(editor.request("clisc/unheardOf", json!({}))["error"]["code"], -32601);
    for params in
        [json!(null), json!({}), json!({ "textDocument": { "uri": 7 } }), json!({ "textDocument": { "uri": URI } })]
    {
        assert_eq!(editor.request("textDocument/hover", params)["error"]["code"], -32602);
    }
    editor.note("textDocument/didOpen", json!({ "nothing": 1 }));
    editor
        .note("textDocument/didChange", json!({ "textDocument": { "uri": URI, "version": 3 }, "contentChanges": [] }));
    editor.note("clisc/unheardOf", json!([]));
    editor.open_text(SCENE);
    assert_eq!(editor.diagnostics(), [] as [Value; 0]);
    // Places that do not exist are the nearest that do.
    assert!(editor.ask_at("hover", 4_000_000_000, 4_000_000_000).is_null());
    editor.ask_about("formatting", json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
    let document = json!({ "uri": URI, "version": 2 });
    let changes = json!([{ "range": range((99, 0), (2, 7)), "text": "sphere\r" }, { "text": "fov 0" }]);
    editor.note("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    editor.version = 2;
    assert!(editor.codes().contains(&"E0401".to_owned()));
    assert_eq!(editor.leave(), Some(0));
}

/// Whatever reaches the server first, a request is answered once.
#[test]
fn a_cancelled_request_is_answered_once() {
    let mut editor = Editor::open(&"sphere 0 0 -4 1\n".repeat(20_000));
    let mut frames = String::new();
    for id in 100..120 {
        let params = json!({ "textDocument": { "uri": URI } });
        frames +=
            &frame(&json!({ "jsonrpc": "2.0", "id": id, "method": "textDocument/documentSymbol", "params": params }));
    }
    for id in 101..120 {
        frames += &frame(&json!({ "jsonrpc": "2.0", "method": "$/cancelRequest", "params": { "id": id } }));
    }
    editor.send_bytes(frames.as_bytes());
    let mut n_cancelled = 0;
    for id in 100..120 {
        let answer = editor.wait_for(|frame| frame["id"] == id);
        let is_cancelled = answer["error"]["code"] == -32800;
        assert!(is_cancelled || answer["result"].is_array(), "{answer}");
        n_cancelled += usize::from(is_cancelled);
    }
    assert!(n_cancelled > 0, "none of 19 requests was still waiting when it was cancelled");
    assert_eq!(editor.leave(), Some(0));
}

#[test]
fn exit_codes_say_whether_the_editor_said_goodbye() {
    assert_eq!(Editor::open(SCENE).leave(), Some(0));
    assert_eq!(Editor::open(SCENE).end(), Some(1), "the pipe is closed");
    let mut editor = Editor::open(SCENE);
    editor.note("exit", Value::Null);
    assert_eq!(editor.end(), Some(1), "`exit` without `shutdown`");
    let mut editor = Editor::open(SCENE);
    editor.ask("shutdown", Value::Null);
    let hover = json!({ "textDocument": { "uri": URI }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.request("textDocument/hover", hover)["error"]["code"], -32600);
    editor.note("exit", Value::Null);
    assert_eq!(editor.end(), Some(0));
}
