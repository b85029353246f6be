// Stubs: the types of Unity for memory outside its heap that the package uses, for elements of four bytes.
using System;
using System.Runtime.InteropServices;

namespace Unity.Collections
{
    public enum Allocator
    {
        Persistent,
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class WriteOnlyAttribute : Attribute
    {
    }

    public struct NativeArray<T> : IDisposable where T : struct
    {
        internal IntPtr Address;
        public int Length { get; private set; }

        public NativeArray(int length)
        {
            Length = length;
            Address = Marshal.AllocHGlobal(4 * length);
        }

        public NativeArray(int length, Allocator allocator) : this(length)
        {
        }

        public T this[int index]
        {
            get { return (T)Marshal.PtrToStructure(IntPtr.Add(Address, 4 * index), typeof(T)); }
            set { Marshal.StructureToPtr(value, IntPtr.Add(Address, 4 * index), false); }
        }

        public void Dispose()
        {
            Marshal.FreeHGlobal(Address);
        }
    }

    public static class Floats
    {
        public static void Clear(this NativeArray<float> array)
        {
            Marshal.Copy(new float[array.Length], 0, array.Address, array.Length);
        }

        public static void CopyTo(this NativeArray<float> array, float[] to, int offset)
        {
            Marshal.Copy(array.Address, to, offset, array.Length);
        }
    }
}

namespace Unity.Collections.LowLevel.Unsafe
{
    public static class NativeArrayUnsafeUtility
    {
        public static unsafe void* GetUnsafePtr<T>(NativeArray<T> array) where T : struct
        {
            return (void*)array.Address;
        }
    }
}
