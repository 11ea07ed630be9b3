#include <slipstick/app/interruption.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

#include <unistd.h>

namespace slipstick::app
{
  namespace
  {
    // bytes; longer texts are truncated
    constexpr std::size_t longest_text = 1000;

    // A handler may interrupt the writing of a text; it always reads the text that is not being written.
    std::array<std::array<char, longest_text>, 2> texts;
    std::array<std::atomic<std::size_t>, 2>       lengths;
    std::atomic<int>                              present{-1};
    std::atomic<bool>                             is_held{false};
    std::atomic<int>                              held_signal{0}; // 0: none

    void tell(const int signal)
    {
      // only async-signal-safe functions: POSIX.1-2017, 2.4.3
      if (is_held.load())
        {
          held_signal = signal;
          return;
        }
      const int k = present.load();
      if (k >= 0 && write(STDERR_FILENO, texts[k].data(), lengths[k].load()) < 0)
        {} // nothing can be done
      std::signal(signal, SIG_DFL);
      raise(signal);
    }
  } // namespace

  void tell_when_interrupted(const std::string &text)
  {
    const int  next   = present.load() == 0 ? 1 : 0;
    const auto line   = "\nerror: interrupted " + text + "\n";
    const auto length = std::min(line.size(), longest_text);
    std::memcpy(texts[next].data(), line.data(), length);
    lengths[next]     = length;
    const bool is_new = present.exchange(next) < 0;
    if (!is_new)
      return;
    for (const int signal : {SIGINT, SIGTERM})
      {
        struct sigaction action = {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler != SIG_IGN) // e.g. background jobs of a shell, or under nohup
          std::signal(signal, tell);
      }
  }

  void do_not_tell_when_interrupted()
  {
    present = -1;
    for (const int signal : {SIGINT, SIGTERM})
      {
        struct sigaction action = {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler == tell)
          std::signal(signal, SIG_DFL);
      }
  }

  HeldInterruption::HeldInterruption()
  {
    is_held = true;
  }

  HeldInterruption::~HeldInterruption()
  {
    is_held = false;
    if (const int signal = held_signal.exchange(0))
      raise(signal);
  }
} // namespace slipstick::app
