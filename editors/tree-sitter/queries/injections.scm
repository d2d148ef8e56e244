((comment) @injection.content
  (#set! injection.language "comment"))

; The command that starts the system under test.
(setting
  "run"
  value: (string (string_content) @injection.content)
  (#set! injection.language "bash"))
