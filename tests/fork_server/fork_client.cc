// fork_client ARGUMENTS...: slipstick run by the fork_server at $SLIPSTICK_FORK_SOCKET, with the arguments, environment, folder,
// limits and standard descriptors of this process. Its signals go to the run, whose exit status or signal becomes its own.
#include "request.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <sys/wait.h>

extern char **environ;

namespace
{
  using namespace slipstick::test;

  constexpr std::array<int, 4> forwarded = {{SIGHUP, SIGINT, SIGQUIT, SIGTERM}};
  volatile pid_t               child     = 0;

  [[noreturn]] void fail(const char *what)
  {
    std::perror(what);
    std::exit(cannot_start);
  }
} // namespace

int main(int argc, char **argv)
{
  const char *const socket = std::getenv("SLIPSTICK_FORK_SOCKET");
  const int         server = socket ? connect_to(socket) : -1;
  if (server < 0)
    fail("fork_client: no server at SLIPSTICK_FORK_SOCKET");

  Request request;
  request.arguments.assign(argv + 1, argv + argc);
  for (char **variable = environ; *variable; ++variable)
    request.environment.emplace_back(*variable);
  request.directory = std::filesystem::current_path();
  for (unsigned int i = 0; i < limited.size(); ++i)
    getrlimit(limited[i], &request.limits[i]);

  // signals wait until there is a run
  sigset_t signals, mask;
  sigemptyset(&signals);
  for (const int number : forwarded)
    sigaddset(&signals, number);
  sigprocmask(SIG_BLOCK, &signals, &mask);
  if (!send(server, request))
    fail("fork_client: the server does not listen");
  const auto started = receive_number(server);
  if (!started)
    fail("fork_client: the server does not answer");
  child = *started;
  for (const int number : forwarded)
    {
      struct sigaction action = {};
      action.sa_handler       = [](const int signal) { kill(child, signal); };
      action.sa_flags         = SA_RESTART;
      sigaction(number, &action, nullptr);
    }
  sigprocmask(SIG_SETMASK, &mask, nullptr);

  const auto status = receive_number(server);
  if (!status)
    fail("fork_client: the server has ended");
  if (WIFSIGNALED(*status))
    {
      const rlimit no_core = {0, 0};
      setrlimit(RLIMIT_CORE, &no_core);
      std::signal(WTERMSIG(*status), SIG_DFL);
      raise(WTERMSIG(*status));
    }
  return WEXITSTATUS(*status);
}
