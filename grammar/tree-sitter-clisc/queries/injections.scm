; Marks of work to be done, and links, where the editor has a grammar for them.

((comment) @injection.content
  (#set! injection.language "comment"))
