"""Types a line into an interactive shell in a terminal of its own, presses Tab and prints the words that it became.

complete_in_terminal.py bash|zsh 'score --progress j'

The line is what follows "pilotage". After the Tab the line is made an argument of `printf`; the shell takes the keys one
after the other, so nothing has to be waited for but the answer. The last word ends in "." where the cursor stood right
behind it (nothing was completed, or more may follow)."""

import os
import pty
import select
import sys
import time

SHELLS = {
    "bash": (["bash", "--norc", "--noprofile", "-i"], "source <(pilotage completion bash)"),
    "zsh": (["zsh", "-f", "-i"], "autoload -Uz compinit && compinit -u -D && source <(pilotage completion zsh)"),
}


def read_until(terminal, mark, limit_s=60):
    seen, end = b"", time.monotonic() + limit_s
    while mark not in seen:
        if not select.select([terminal], [], [], max(0, end - time.monotonic()))[0]:
            raise SystemExit(f"{mark!r} not seen within {limit_s} s, but: {seen!r}")
        seen += os.read(terminal, 4096)
    return seen.decode()


def main():
    command, setup = SHELLS[sys.argv[1]]
    child, terminal = pty.fork()
    if child == 0:
        os.environ.update(TERM="dumb", PS1="> ", INPUTRC="/dev/null", HISTFILE="")
        os.execvp(command[0], command)
    os.write(terminal, f"{setup} && echo REA''DY\n".encode())
    read_until(terminal, b"READY")
    os.write(terminal, f"pilotage {sys.argv[2]}\t.\x01printf '<%s>' \x05; echo EN''D\n".encode())
    words = read_until(terminal, b"END").rsplit("<pilotage>", 1)
    print(words[-1].split("END")[0].strip())
    os.close(terminal)
    os.waitpid(child, 0)


main()
