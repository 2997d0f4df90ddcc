#pragma once

namespace alabaster {

/// Makes Ctrl-C (SIGINT) and SIGTERM ask for an orderly stop; a second Ctrl-C ends the process at once.
void install_cancellation_handler();
/// True once a stop was asked for. Long work polls it and leaves valid output of what is done.
bool cancellation_requested();
/// Asks for a stop as Ctrl-C does (tests).
void request_cancellation();
void clear_cancellation();

}  // namespace alabaster
