#include <slipstick/app/restart.h>
#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>

#include <deal.II/base/mpi.h>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/serialization/array.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/set.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>

// NOLINTBEGIN: Boost finds these functions by the namespace of their argument
namespace slipstick
{
  template <class Archive>
  void serialize(Archive &a, Resultant &x, const unsigned int)
  {
    a &x.force &x.moment;
  }

  namespace contact
  {
    template <class Archive>
    void serialize(Archive &a, PairResult &x, const unsigned int)
    {
      a &x.pair &x.on_slave &x.normal_force &x.tangential_force &x.moment_mismatch &x.max_pressure &x.contact_length &x
        .contact_nodes &x.open_nodes &x.stick_nodes &x.open_slip_nodes &x.slip_nodes &x.norm.pressure &x.norm
        .tangential &x.algebraic_error.pressure &x.algebraic_error.tangential;
    }
    template <class Archive>
    void serialize(Archive &a, History &x, const unsigned int)
    {
      a &x.displacement &x.force &x.traction &x.energies;
    }
  } // namespace contact

  namespace output
  {
    template <class Archive>
    void serialize(Archive &a, ConvergenceRow &x, const unsigned int)
    {
      a &x.step &x.algorithm &x.friction_step &x.outer_step &x.hessian_multiplications &x.projected_gradient &x
        .equality &x.at_lower_bound &x.at_upper_bound &x.free;
    }
    template <class Archive>
    void serialize(Archive &a, ContactStep &x, const unsigned int)
    {
      a &x.step &x.nodes &x.faces;
    }
    template <class Archive>
    void serialize(Archive &a, ProbeValues &x, const unsigned int)
    {
      a &x.distance &x.position &x.displacement &x.stress &x.von_mises;
    }
    template <class Archive>
    void serialize(Archive &a, ProbeResult &x, const unsigned int)
    {
      a &x.name &x.is_point &x.points;
    }
    template <class Archive>
    void serialize(Archive &a, PretensionResult &x, const unsigned int)
    {
      a &x.name &x.force &x.shortening &x.is_tightened;
    }
    template <class Archive>
    void serialize(Archive &a, NamedResultant &x, const unsigned int)
    {
      a &x.name &x.kind &x.sum;
    }
    template <class Archive>
    void serialize(Archive &a, ForceSummary &x, const unsigned int)
    {
      a &x.loads &x.supports &x.foundations;
    }
    template <class Archive>
    void serialize(Archive &a, StepSummary &x, const unsigned int)
    {
      a &x.load_factor &x.hessian_multiplications &x.outer_iterations &x.coulomb_iterations &x.max_displacement &x
        .strain_energy &x.contact &x.forces &x.probes &x.pretensions;
    }
    template <class Archive>
    void serialize(Archive &a, SolverSummary &x, const unsigned int)
    {
      a &x.algorithm &x.preconditioner &x.dual_operator &x.tolerance &x.hessian_multiplications &x
        .dual_setup_multiplications &x.preconditioner_applications &x.outer_iterations &x.cg_steps &x.expansion_steps &x
        .proportioning_steps &x.coulomb_iterations &x.fallbacks &x.active_constraints &x.dual_norm;
    }
    template <class Archive>
    void serialize(Archive &a, ResidualSummary &x, const unsigned int)
    {
      a &x.projected_gradient &x.equality &x.interface_jump &x.penetration &x.complementarity &x.friction_bound &x
        .force_balance &x.moment_balance &x.tension &x.nodal_equilibrium;
    }
    template <class Archive>
    void serialize(Archive &a, Place &x, const unsigned int)
    {
      a &x.body &x.position;
    }
    template <class Archive>
    void serialize(Archive &a, ErrorSummary &x, const unsigned int)
    {
      a &x.estimate_energy_relative &x.algebraic_relative &x.largest_at &x.largest_part;
    }
    template <class Archive>
    void serialize(Archive &a, ResultSummary &x, const unsigned int)
    {
      a &x.max_displacement &x.max_von_mises &x.max_von_mises_at &x.singular &x.probes &x.strain_energy &x.contact &x
        .forces            &x.pretensions;
      bool                  is_revolved = x.hoop_stress.has_value();
      std::array<double, 2> hoop_stress = x.hoop_stress.value_or(std::array<double, 2>());
      a &is_revolved       &hoop_stress;
      x.hoop_stress = is_revolved ? std::optional(hoop_stress) : std::nullopt;
    }
    template <class Archive>
    void serialize(Archive &a, DualSummary &x, const unsigned int)
    {
      a &x.total &x.equality &x.normal &x.tangential;
    }
    template <class Archive>
    void serialize(Archive &a, ProblemSummary &x, const unsigned int)
    {
      a &x.dimension &x.plane_state &x.bodies &x.subdomains &x.primal_dofs &x.kernel_dimension &x.cells &x.dual &x
        .contact_candidates;
    }
    // times and memory belong to the process
    template <class Archive>
    void serialize(Archive &a, Summary &x, const unsigned int)
    {
      a &x.case_name &x.version &x.ranks &x.status &x.problem &x.solver &x.residuals &x.error &x.results &x.steps &x
        .warnings;
    }
  } // namespace output

  namespace app
  {
    template <class Archive>
    void serialize(Archive &a, StepState::Direction &x, const unsigned int)
    {
      a &x.p &x.Fp &x.error;
    }
    template <class Archive>
    void serialize(Archive &a, StepState &x, const unsigned int)
    {
      a &x.kept_part &x.largest_load &x.built_at &x.history &x.rows &x.labels &x.multipliers &x.has_gradient &x
        .gradient &x.reference &x.weighted_reference &x.largest_forces &x.largest_traction &x.u &x.directions &x.bolts;
    }
    template <class Archive>
    void serialize(Archive &a, RunState &x, const unsigned int)
    {
      a &x.solver &x.summary &x.contact_steps &x.total_slip &x.largest_force &x.warnings &x.warned_about;
    }
  } // namespace app
} // namespace slipstick
// NOLINTEND

namespace slipstick::app
{
  namespace
  {
    const std::string head_name = "restart.bin";
    // Number of the file format; it must change with the layout.
    constexpr unsigned int format_number = 11;

    /// Contents of restart.bin: identifies the run to which the files belong.
    struct Head
    {
      unsigned int             format = format_number;
      std::string              version;
      unsigned int             ranks = 0;
      unsigned int             steps = 0;
      std::string              parameters; // without the load factors
      std::vector<double>      load_factors;
      std::vector<std::string> files; // meshes of bodies, surfaces of obstacles
      std::vector<std::size_t> sums_of_files;

      template <class Archive>
      void serialize(Archive &a, const unsigned int)
      {
        a &format;
        if (format == format_number)
          a &version &ranks &steps &parameters &load_factors &files &sums_of_files;
      }
    };

    /// FNV-1a hash (Fowler, Noll, Vo) of a file.
    std::size_t sum_of(const std::string &file)
    {
      std::ifstream in(file, std::ios::binary);
      std::uint64_t sum = 0xcbf29ce484222325u;
      for (auto c = std::istreambuf_iterator<char>(in); c != std::istreambuf_iterator<char>(); ++c)
        sum = (sum ^ static_cast<unsigned char>(*c)) * 0x100000001b3u;
      return sum;
    }

    /// Data of rank 0.
    template <int dim>
    Head head_of(const scene::Scene<dim> &scene, const unsigned int steps, const unsigned int ranks)
    {
      static const std::regex factors("\n *set Factors *=[^\n]*");
      Head                    head;
      head.version      = SLIPSTICK_VERSION;
      head.ranks        = ranks;
      head.steps        = steps;
      head.parameters   = std::regex_replace(scene.parameters, factors, "");
      head.load_factors = scene.load_factors;
      for (const auto &body : scene.bodies)
        head.files.push_back(body.file);
      for (const auto &obstacle : scene.obstacles)
        head.files.push_back(obstacle.file);
      head.files.erase(std::remove(head.files.begin(), head.files.end(), ""), head.files.end());
      for (const auto &file : head.files)
        head.sums_of_files.push_back(sum_of(file));
      return head;
    }

    std::string file_of(const unsigned int steps, const unsigned int rank)
    {
      return format("restart_%03u_%04u.bin", steps, rank);
    }

    template <class T>
    void write_binary(const output::OutputDirectory &directory, const std::string &name, const T &content)
    {
      directory.write(name, [&content](std::ostream &out) { boost::archive::binary_oarchive(out) << content; });
    }

    [[noreturn]] void refuse(const std::string &problem)
    {
      throw InputError("--resume: " + problem, "omit --resume to start from the first load step");
    }

    template <class T>
    T read_binary(const output::OutputDirectory &directory, const std::string &name)
    {
      std::ifstream in(directory.path(name), std::ios::binary);
      if (!in)
        refuse("'" + directory.path(name) + "' does not exist or cannot be read");
      T content;
      try
        {
          boost::archive::binary_iarchive(in) >> content;
        }
      catch (const std::exception &) // any error caused by a damaged file
        {
          refuse("'" + directory.path(name) + "' is damaged or from another version");
        }
      return content;
    }

    /// The first line of the second text that differs from the first text.
    std::string first_difference(const std::string &before, const std::string &now)
    {
      std::istringstream a(before), b(now);
      std::string        of_before, of_now;
      for (;;)
        {
          const bool more = static_cast<bool>(std::getline(a, of_before));
          if (!std::getline(b, of_now) || !more || of_before != of_now)
            return of_now.substr(std::min(of_now.size(), of_now.find_first_not_of(' ')));
        }
    }

    void check_same(const Head &before, const Head &now, const std::string &path)
    {
      if (before.format != now.format)
        refuse(format("the restart files in '%s' have another format (%u; this version of slipstick writes %u)",
                      path.c_str(),
                      before.format,
                      now.format));
      if (before.version != now.version)
        refuse("the files in '" + path + "' are from version " + before.version + " of slipstick, this is " +
               now.version);
      if (before.ranks != now.ranks)
        refuse(format("the run in '%s' had %u ranks, this one has %u", path.c_str(), before.ranks, now.ranks));
      if (before.parameters != now.parameters)
        refuse("the scene differs from that of the run in '" + path + "', first at '" +
               first_difference(before.parameters, now.parameters) + "'");
      for (std::size_t i = 0; i < now.files.size(); ++i)
        if (i >= before.files.size() || before.sums_of_files[i] != now.sums_of_files[i])
          refuse("the file '" + now.files[i] + "' has changed since the run in '" + path + "'");
      for (unsigned int step = 0; step < before.steps; ++step)
        if (step >= now.load_factors.size() || before.load_factors[step] != now.load_factors[step])
          refuse(
            format("load step %u of the run in '%s' ended with t = %g, which is not among the Factors of this scene",
                   step + 1,
                   path.c_str(),
                   before.load_factors[step]));
    }

    /// Removes the restart files, except those of step @p but.
    void remove_files(const output::OutputDirectory &directory, const std::optional<unsigned int> but)
    {
      static const std::regex            files("restart_(\\d+)_\\d+\\.bin");
      std::error_code                    error; // files that cannot be removed are kept
      std::vector<std::filesystem::path> old;
      for (const auto &entry : std::filesystem::directory_iterator(directory.path(), error))
        {
          std::smatch       match;
          const std::string name = entry.path().filename().string();
          if (std::regex_match(name, match, files) && (!but || std::stoul(match[1]) != *but))
            old.push_back(entry.path());
        }
      for (const auto &file : old)
        std::filesystem::remove(file, error);
    }
  } // namespace

  template <int dim>
  void write_restart(const output::OutputDirectory &directory,
                     const scene::Scene<dim>       &scene,
                     const RunState                &state,
                     const MPI_Comm                 comm)
  {
    const unsigned int rank  = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int steps = state.summary.steps.size();
    collectively(comm, [&] { write_binary(directory, file_of(steps, rank), state); });
    collectively(comm, [&] {
      if (rank > 0)
        return;
      write_binary(directory, head_name, head_of(scene, steps, dealii::Utilities::MPI::n_mpi_processes(comm)));
      remove_files(directory, steps);
    });
  }

  template <int dim>
  RunState read_restart(const output::OutputDirectory &directory, const scene::Scene<dim> &scene, const MPI_Comm comm)
  {
    const unsigned int rank  = dealii::Utilities::MPI::this_mpi_process(comm);
    unsigned int       steps = 0;
    collectively(comm, [&] {
      if (rank > 0)
        return;
      if (!std::filesystem::exists(directory.path(head_name)))
        refuse("there is no run in '" + directory.path() +
               "' to continue: none was started, none of its load steps was finished, or all of them were");
      const auto head = read_binary<Head>(directory, head_name);
      check_same(head, head_of(scene, 0, dealii::Utilities::MPI::n_mpi_processes(comm)), directory.path());
      steps = head.steps;
    });
    steps = dealii::Utilities::MPI::broadcast(comm, steps);
    RunState state;
    collectively(comm, [&] { state = read_binary<RunState>(directory, file_of(steps, rank)); });
    return state;
  }

  void remove_restart(const output::OutputDirectory &directory, const MPI_Comm comm)
  {
    collectively(comm, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(comm) > 0)
        return;
      std::error_code error;
      std::filesystem::remove(directory.path(head_name), error);
      remove_files(directory, {});
    });
  }

  template void     write_restart(const output::OutputDirectory &,
                                  const scene::Scene<2> &,
                                  const RunState &,
                                  const MPI_Comm);
  template RunState read_restart(const output::OutputDirectory &, const scene::Scene<2> &, const MPI_Comm);
  template void     write_restart(const output::OutputDirectory &,
                                  const scene::Scene<3> &,
                                  const RunState &,
                                  const MPI_Comm);
  template RunState read_restart(const output::OutputDirectory &, const scene::Scene<3> &, const MPI_Comm);
} // namespace slipstick::app
