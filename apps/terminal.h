#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace plumbline {

// Output of the programs on a terminal: a status line that is rewritten in place, messages
// above it, and colours. All of it goes through here, so that nothing lands in the middle of
// the status line.

enum class Colour { kGreen, kYellow, kRed };

// Whether a stream is a terminal that can rewrite a line (TERM is not "dumb").
bool IsTerminal(FILE* stream);

// Returns how many columns the terminal of a file descriptor has; 80 where it does not tell.
size_t Columns(int descriptor);

// Returns the text in a colour where the stream is a terminal and the user has not asked for
// none (NO_COLOR, https://no-color.org), else the text.
std::string Coloured(const std::string& text, Colour colour, FILE* stream);

// Rewrites the status line of stderr, cut to the width of the terminal; "" takes it away. Only
// for terminals.
void ShowStatus(const std::string& text);

// Writes a line on stderr; the status line, if there is one, moves below it.
void PrintOnStderr(const std::string& line);

// Sends what glog has to say to stderr, never to files: on a terminal the bare message,
// warnings marked as such, else with the time and the place in the source. May be called
// again.
void LogToTerminal(const char* program);

}  // namespace plumbline
