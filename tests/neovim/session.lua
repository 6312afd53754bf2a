-- A session in a real editor: a scene with an error is opened and told of, mended and formatted, and told to be sound.
-- tests/neovim/run starts it; the editor ends with 1 and says why when something is missing.

-- How long anything may take, in milliseconds; generous, since nothing is measured here.
local PATIENCE = 60000

local function fail(message)
  io.stderr:write("neovim: " .. message .. "\n")
  vim.cmd("cquit 1")
end

local function wait_for(what, is_so)
  if not vim.wait(PATIENCE, is_so, 20) then
    fail("waited in vain for " .. what .. "; the diagnostics are " .. vim.inspect(vim.diagnostic.get(0)))
  end
end

local function attach()
  local config = { name = "clisc", cmd = { vim.env.CLISC, "lsp" }, root_dir = vim.fn.getcwd() }
  if vim.lsp.start then
    return vim.lsp.start(config)
  end
  -- Before Neovim 0.8.
  local client = vim.lsp.start_client(config)
  vim.lsp.buf_attach_client(0, client)
  return client
end

local function format()
  if vim.lsp.buf.format then
    vim.lsp.buf.format({ timeout_ms = PATIENCE })
  else
    vim.lsp.buf.formatting_sync(nil, PATIENCE)
  end
end

local function line(number)
  return vim.api.nvim_buf_get_lines(0, number, number + 1, true)[1]
end

vim.cmd("edit " .. vim.fn.fnameescape(vim.env.SCENE))
local client = attach()
if not client then
  fail("the server does not start")
end

wait_for("the error", function()
  return #vim.diagnostic.get(0) == 1
end)
local found = vim.diagnostic.get(0)[1]
if not (found.message:find("did you mean `sphere`", 1, true) and found.severity == vim.diagnostic.severity.ERROR) then
  fail("another message than the one expected: " .. vim.inspect(found))
end
if line(found.lnum):sub(found.col + 1, found.end_col) ~= "shpere" then
  fail("the message is at another place: " .. vim.inspect(found))
end

vim.api.nvim_buf_set_text(0, found.lnum, found.col, found.lnum, found.end_col, { "sphere" })
wait_for("a scene without errors", function()
  return #vim.diagnostic.get(0) == 0
end)

format()
wait_for("the canonical form", function()
  return line(found.lnum) == "sphere  0 0 -4   1  # π 😀"
end)
wait_for("a scene without errors once more", function()
  return #vim.diagnostic.get(0) == 0
end)

vim.lsp.stop_client(client)
vim.cmd("qall!")
