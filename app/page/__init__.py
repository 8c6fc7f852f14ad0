"""What the workbench adds to viser's page in the browser: panels by key, help, and a tour for the first visit."""

from app.page.commands import add_commands as add_commands
from app.page.script import install as install
